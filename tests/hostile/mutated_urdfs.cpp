// Invalid URDFs, in text or tree. Each must be rejected with an error, or read, described and
// posed.
//
//   mutated_urdfs [COUNT [SEED]]
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "avatars/avatars.h"
#include "avatars/model/describe.h"
#include "base/random.h"
#include "kinematics/kdl_tree.h"
#include "tests/hostile/hostile_case.h"
#include "tests/kinematics/finite_poses.h"

namespace throng::hostile {
namespace {

/// Every kind of joint and geometry, unused tags, markers, limits, a mimic joint.
constexpr const char* kEverything = R"(<?xml version="1.0"?>
<!-- all of it -->
<robot name="everything">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base"><inertial><origin xyz="0 0 0.1" rpy="0 0 0.1"/><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial><visual><origin xyz="0 0 0.2" rpy="0.1 0 0"/><geometry><box size="0.4 0.3 0.2"/></geometry><material name="grey"/></visual></link>
  <link name="wheel"><collision><geometry><cylinder radius="0.1" length="0.05"/></geometry></collision></link>
  <link name="mast"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="head"><visual><geometry><mesh filename="HEAD" scale="1 1 1"/></geometry></visual></link>
  <link name="follower"><visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual></link>
  <link name="marker"><visual><geometry><box size="0 0 0"/></geometry></visual></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="wheel"/><origin xyz="0 0.2 0.1" rpy="1.57 0 0"/><axis xyz="0 0 1"/><dynamics damping="0.1"/></joint>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="mast"/><axis xyz="0 0 1"/><limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>
  <joint name="nod" type="revolute"><parent link="mast"/><child link="head"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="follow" type="revolute"><parent link="mast"/><child link="follower"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="nod" multiplier="0.5" offset="0.1"/></joint>
  <joint name="stuck" type="fixed"><parent link="head"/><child link="marker"/></joint>
  <gazebo reference="base"><sensor type="ray"/></gazebo>
  <transmission name="t"><joint name="turn"/></transmission>
</robot>
)";

constexpr const char* kValues[] = {"",
                                   " ",
                                   "0",
                                   "-0",
                                   "-1",
                                   "1e-300",
                                   "1e300",
                                   "-1e300",
                                   "1e999",
                                   "nan",
                                   "inf",
                                   "-inf",
                                   "0 0 0",
                                   "0 0 1",
                                   "1 2",
                                   "1 2 3 4",
                                   "nan nan nan",
                                   "1e300 1e300 1e300",
                                   "1e-300 0 0",
                                   "1,2,3",
                                   "0x10",
                                   "9999 9999 9999",
                                   "10001 0 0",
                                   "base",
                                   "world",
                                   "nod",
                                   "revolute",
                                   "fixed",
                                   "floating",
                                   "planar",
                                   "continuous",
                                   "package://x/y.stl",
                                   "http://example.org/a.stl",
                                   "file:///dev/zero",
                                   "/dev/zero",
                                   "/dev/null",
                                   "..",
                                   "model://",
                                   "package://",
                                   "&amp;&lt;",
                                   "&#0;",
                                   "&#x110000;",
                                   "&nothing;",
                                   "a\tb\nc",
                                   "\xff\xfe",
                                   "\xc3\xa4\xe4\xba\xba",
                                   "true",
                                   "1 1 0",
                                   "0.0000001 1 1"};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string repeated(const std::string& piece, size_t times) {
  std::string out;
  for (size_t i = 0; i < times; ++i) out += piece;
  return out;
}

std::vector<std::string> seeds() {
  const std::filesystem::path source = THRONG_SOURCE_DIR;
  const std::string models = (source / "avatars/models/adult/").string();
  std::vector<std::string> all{replaced(kEverything, "HEAD", models + "head.tri"),
                               replaced(text_of(source / "avatars/models/adult/adult.urdf"),
                                        "filename=\"", "filename=\"" + models)};
  for (const char* name : {"mimic_hand", "skew_arm", "wheels", "bush", "single"})
    all.push_back(text_of(source / "tests/kinematics/fixtures" / (std::string(name) + ".urdf")));
  all.push_back(
      text_of(source / "tests/kinematics/fixtures/humanoid_description/urdf/humanoid.urdf"));
  all.push_back(text_of(source / "scenes/bundled/robot/robot.urdf"));
  return all;
}

/// Large URDFs, on which quadratic algorithms take minutes.
std::vector<std::string> giants() {
  const auto robot = [](const std::string& inner) {
    return "<robot name='r'><link name='a'/>" + inner + "</robot>";
  };
  constexpr size_t kMaxBytes = size_t{16} << 20;
  std::string attributes, joints, visuals, entities;
  for (int i = 0; i < 100'000; ++i) attributes += fmt::format(" a{}='1'", i);
  const std::string prefix(100, 'p');
  for (int i = 0; i < 2000; ++i)
    joints += fmt::format(
        "<link name='{0}{1}'/><joint name='{0}{1}' type='fixed'><parent link='a'/><child "
        "link='{0}{1}'/></joint>",
        prefix, i);
  std::string chain;
  for (int i = 0; i < 2000; ++i)
    chain += fmt::format(
        "<link name='l{1}'/><joint name='j{1}' type='continuous'><parent link='{0}'/><child "
        "link='l{1}'/><axis xyz='0 0 1'/>{2}</joint>",
        i == 0 ? std::string("a") : fmt::format("l{}", i - 1), i,
        i == 0 ? "" : fmt::format("<mimic joint='j{}'/>", i - 1));
  for (int i = 0; i < 60'000; ++i)
    visuals += "<visual><geometry><sphere radius='1'/></geometry></visual>";
  return {robot(std::string(kMaxBytes - 100, ' ')),
          robot(std::string(kMaxBytes - 100, '\n')),
          robot("<!--" + std::string(kMaxBytes - 100, '-') + "-->"),
          robot(repeated("<!---->", kMaxBytes / 7 - 20)),
          robot(repeated("<?a?>", kMaxBytes / 5 - 20)),
          robot("<![CDATA[" + std::string(kMaxBytes - 100, ']') + "]]>"),
          robot(repeated("<![CDATA[x]]>", kMaxBytes / 13 - 20)),
          robot(repeated("&amp;", kMaxBytes / 5 - 20)),
          robot(repeated("&", kMaxBytes - 100)),
          robot(std::string(kMaxBytes - 100, 'x')),
          robot("<x" + attributes + "/>"),
          robot("<" + std::string(kMaxBytes - 100, 'n') + "/>"),
          robot("<x " + std::string(kMaxBytes - 100, 'n') + "='1'/>"),
          robot("<x n='" + std::string(kMaxBytes - 100, 'v') + "'/>"),
          robot(repeated("<x n='" + std::string(4090, '&') + "'/>", kMaxBytes / 4200)),
          robot(repeated("<x/>", 199'000)),
          robot(repeated("<x><y/></x>", 99'000)),
          robot(repeated("<x>", 100'000)),
          robot(joints),
          robot(chain),
          "<robot name='r'><link name='a'>" + visuals + "</link></robot>",
          repeated("<", kMaxBytes - 10),
          repeated("<!", kMaxBytes / 2 - 10),
          std::string(kMaxBytes - 10, '\0'),
          robot("") + std::string(kMaxBytes - 100, '\0')};
}

void change_value(std::string& text, Draw& draw) {
  std::vector<size_t> quotes;
  for (size_t at = text.find("=\""); at != std::string::npos; at = text.find("=\"", at + 2))
    quotes.push_back(at + 2);
  if (quotes.empty()) return;
  const size_t begin = quotes[draw.below(quotes.size())];
  const size_t end = text.find('"', begin);
  if (end == std::string::npos) return;
  if (draw.below(4) == 0) {  // value of another attribute
    const size_t other = quotes[draw.below(quotes.size())];
    const size_t other_end = text.find('"', other);
    if (other_end == std::string::npos) return;
    text.replace(begin, end - begin, text.substr(other, other_end - other));
  } else {
    text.replace(begin, end - begin, kValues[draw.below(std::size(kValues))]);
  }
}

/// Removes, duplicates or moves a tag, from '<' to '>'.
void change_tag(std::string& text, Draw& draw) {
  const size_t start = text.find('<', draw.below(text.size()));
  const size_t end = start == std::string::npos ? start : text.find('>', start);
  if (end == std::string::npos) return;
  const std::string tag = text.substr(start, end + 1 - start);
  const size_t kind = draw.below(3);
  if (kind == 0) text.erase(start, tag.size());
  if (kind == 1) text.insert(start, tag);
  if (kind == 2) {
    text.erase(start, tag.size());
    const size_t to = text.find('<', draw.below(text.size()));
    if (to != std::string::npos) text.insert(to, tag);
  }
}

void change_bytes(std::string& text, Draw& draw) {
  const size_t at = draw.below(text.size());
  switch (draw.below(5)) {
    case 0:
      text[at] = static_cast<char>(draw.below(256));
      return;
    case 1:
      text.erase(at, 1 + draw.below(40));
      return;
    case 2:
      text.resize(at);
      return;
    case 3:
      text.insert(at, draw.below(2) == 0 ? std::string(1 + draw.below(3), '\0') : "<!-- ");
      return;
    default:
      text.insert(at, text.substr(draw.below(text.size()), 1 + draw.below(200)));
  }
}

void use(const std::string& text, const std::filesystem::path& file) {
  const Robot robot = parse_urdf(text, file);
  if (robot.links.size() != robot.joints.size() + 1) throw std::runtime_error("not a tree");
  if (!has_finite_poses(robot)) throw std::runtime_error("a link without a finite pose");
  if (to_kdl(robot).getNrOfSegments() != robot.joints.size())
    throw std::runtime_error("a KDL tree of other links");
  bool is_complete = false;
  if (describe_urdf(file, is_complete).empty()) throw std::runtime_error("no description");
}

int run(const Arguments& arguments) {
  const Scratch scratch;
  const std::vector<std::string> sound = seeds();
  Tally tally;
  const auto attempt = [&](const std::string& text, const std::string& name) {
    const std::filesystem::path file = scratch.write("robot.urdf", text);
    try_case(
        text, fmt::format("hostile_urdf_{}_{}.urdf", arguments.seed, name),
        [&] { use(text, file); }, tally);
  };
  // Unchanged, first.
  for (size_t i = 0; i < sound.size(); ++i) attempt(sound[i], fmt::format("sound_{}", i));
  if (tally.ran != static_cast<int64_t>(sound.size())) {
    std::fprintf(stderr, "expected %zu sound robots, found %lld\n", sound.size(),
                 static_cast<long long>(tally.ran));
    return 1;
  }
  if (arguments.count >= 1000) {
    const std::vector<std::string> large = giants();
    for (size_t i = 0; i < large.size(); ++i) attempt(large[i], fmt::format("giant_{}", i));
  }
  for (int64_t i = tally.tried; i < arguments.count; ++i) {
    Draw draw(arguments.seed, static_cast<uint64_t>(i));
    std::string text = sound[static_cast<size_t>(i) % sound.size()];
    for (size_t k = 0, changes = 1 + draw.below(3) / 2; k < changes && !text.empty(); ++k) {
      const size_t kind = draw.below(6);
      if (kind < 3)
        change_value(text, draw);
      else if (kind < 5)
        change_tag(text, draw);
      else
        change_bytes(text, draw);
    }
    attempt(text, fmt::format("{}", i));
  }
  return report("URDFs", tally);
}

}  // namespace
}  // namespace throng::hostile

int main(int argc, char** argv) {
  return throng::hostile::run(throng::hostile::read_arguments(argc, argv, 3000));
}
