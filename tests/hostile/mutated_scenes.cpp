// Invalid scenes: every bundled scene and some with every key, with values replaced, swapped,
// duplicated and removed. Each must be rejected with an error, or described and run.
//
//   mutated_scenes [COUNT [SEED]]
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/commands/info.h"
#include "avatars/avatars.h"
#include "base/errors.h"
#include "base/random.h"
#include "scenes/file/yaml_tree.h"
#include "scenes/scenes.h"
#include "tests/hostile/hostile_case.h"

namespace throng::hostile {
namespace {

/// Marks text that is written unquoted.
constexpr char kRaw = '\x01';

constexpr const char* kRich[] = {
    R"(name: rich
description: every key of a crowd
seed: 7
step_s: 1/50
duration_s: 3
planted_feet: true
culling: {part_volume: obb, exact: true}
steering: {model: collision_free_speed, density_dependent_speed: true}
ground: {min_m: [-12, -9], max_m: [12, 9]}
groups:
  - name: walkers
    count: 6
    spawn: {min_m: [-11, -8], max_m: [-4, 8]}
    sources: [{area: {min_m: [-11.5, -2], max_m: [-10.5, 2]}, count: 3, rate_per_s: 2, start_s: 0.5, arrivals: poisson}]
    goals: [{min_m: [2, -2], max_m: [4, 2], wait_s: {mean: 1, std_dev: 0.5, min: 0, max: 2}, waypoint: false, capacity: 2, queue: {spacing_m: 0.8, line: [[1, 0], [1, 3], [-1, 3]]}}, {any_of: [{min_m: [9, -8], max_m: [11, -5]}, {min_m: [9, 5], max_m: [11, 8]}], waypoint: true}]
    on_arrival: leave
    premovement_s: {mean: 1, std_dev: 0.5, min: 0, max: 3}
    model: adult
    ages: {adults: 1, children: 2, elderly: 1}
    desired_speed_mps: {mean: 1.2, std_dev: 0.2, min: 0.5, max: 2}
    height_m: {mean: 1.6, std_dev: 0.1, min: 1.2, max: 1.9}
    gait_styles: {plain: 3, brisk: 1, pockets: 1}
    radius_m: 0.24
  - {name: stayers, count: 2, spawn: {min_m: [5, -3], max_m: [7, 3]}, goals: [{min_m: [5, -3], max_m: [7, 3]}], on_arrival: stay, ages: mixed, gait_styles: relaxed, desired_speed_mps: 1.1, premovement_s: 0.2}
  - {name: robots, count: 1, spawn: {min_m: [0, 5], max_m: [2, 8]}, model: ROBOT, control_channel: MY_CART, radius_m: 0.3}
obstacles:
  - {name: wall, kind: box, position_m: [-2, -5], bottom_m: 0, yaw_deg: 30, size_m: [0.3, 4, 2.5]}
  - {name: column, kind: cylinder, position_m: [0, 1], bottom_m: 0.1, diameter_m: 0.8, height_m: 3}
  - {name: needle, kind: mesh, position_m: [3, -6], bottom_m: 0, yaw_deg: -20, file: MESH}
)",
    R"(kind: box
name: rich box
step_s: 0.02
duration_s: 2
culling: {part_volume: {hands: sphere, left legs: obb, default: kdop18}, exact: false}
box: {count: 12, edge_m: 1.5, static_every: 3, min_speed_mps: 0.2, max_speed_mps: 2, max_spin_radps: 4, model: adult}
)",
    R"(name: gap
ground: {min_m: [0, 0], max_m: [6, 3]}
groups: [{count: 3, spawn: {min_m: [0.3, 0.3], max_m: [2, 2.7]}, goals: [{min_m: [4, 1], max_m: [5.5, 2]}]}]
obstacles:
  - {kind: box, position_m: [3, 0.625], size_m: [0.2, 1.25, 2]}
  - {kind: box, position_m: [3, 2.375], size_m: [0.2, 1.25, 2]}
)"};

const std::vector<std::string>& extremes() {
  static const std::vector<std::string> all = {"0",
                                               "-0",
                                               "-1",
                                               "1",
                                               "2",
                                               "0.5",
                                               "-0.001",
                                               "1e-300",
                                               "-1e-300",
                                               "1e300",
                                               "-1e300",
                                               "1e308",
                                               "1e-3",
                                               "1e-9",
                                               "1e5",
                                               "-1e5",
                                               "1e7",
                                               "99999.9",
                                               "2147483647",
                                               "2147483648",
                                               "-2147483649",
                                               "4294967296",
                                               "9223372036854775807",
                                               "9223372036854775808",
                                               "16777215",
                                               "16777216",
                                               "32767",
                                               "32768",
                                               "65535",
                                               "65536",
                                               "0.0499",
                                               "0.1",
                                               "0.10000001",
                                               ".nan",
                                               "nan",
                                               "NaN",
                                               ".inf",
                                               "-.inf",
                                               "inf",
                                               "Infinity",
                                               "1/0",
                                               "0/0",
                                               "1/3",
                                               "-1/60",
                                               "1/1e300",
                                               "1e999",
                                               "0x10",
                                               "1_000",
                                               "1,5",
                                               "''",
                                               "\"\"",
                                               "~",
                                               "null",
                                               "true",
                                               "false",
                                               "yes",
                                               "[]",
                                               "{}",
                                               "[0]",
                                               "[0, 0]",
                                               "[0, 0, 0]",
                                               "[1, 2, 3, 4]",
                                               "[1e-300, 1e-300, 1e-300]",
                                               "[.nan, 0]",
                                               "[[0, 0], [0, 0]]",
                                               "[-1e5, 1e5]",
                                               "{min_m: [0, 0], max_m: [0, 0]}",
                                               "{min_m: [-1, -1], max_m: [1, 1]}",
                                               "{min_m: [-1e5, -1e5], max_m: [1e5, 1e5]}",
                                               "{min_m: [0, 0], max_m: [1e5, 0.1]}",
                                               "{min_m: [0, 0], max_m: [0.04, 5]}",
                                               "{mean: 0, std_dev: 1e300, min: 0, max: 1}",
                                               "{a: b}",
                                               "adult",
                                               "box",
                                               "crowd",
                                               "mesh",
                                               "leave",
                                               "loop",
                                               "mixed",
                                               "orca",
                                               "sphere",
                                               "plain",
                                               "/",
                                               ".",
                                               "..",
                                               "/dev/null",
                                               "/dev/zero",
                                               "/proc/self/mem",
                                               "~root",
                                               "../../../../etc/passwd",
                                               "\"\\u00e4\\u4eba\\u7fa4\"",
                                               "\"a\\0b\"",
                                               "\"a\\nb\"",
                                               "\"\\e[31m\"",
                                               "\"\\xff\\xfe\"",
                                               "menschenmenge",
                                               "\xc3\xa4\xe4\xba\xba",
                                               "\xff\xfe",
                                               std::string("a\0b", 3),
                                               "&a 1",
                                               "*a",
                                               "!!binary AAAA",
                                               "!tag x",
                                               "|",
                                               ">",
                                               "- 1",
                                               "? a",
                                               "\"unfinished",
                                               "[1, 2",
                                               "{a: 1",
                                               std::string(5000, 'x'),
                                               std::string(200, '9'),
                                               "0." + std::string(3000, '1'),
                                               std::string(100, '[') + std::string(100, ']')};
  return all;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

void write(const YamlNode& node, std::string& out) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      out += '~';
      return;
    case YamlNode::Kind::kScalar: {
      const bool is_plain = !node.scalar.empty() && !node.quoted &&
                            std::all_of(node.scalar.begin(), node.scalar.end(), [](char c) {
                              return std::isalnum(static_cast<unsigned char>(c)) || c == '.' ||
                                     c == '_' || c == '+' || c == '/' || c == '-';
                            });
      if (!node.scalar.empty() && node.scalar.front() == kRaw)
        out += node.scalar.substr(1);
      else
        out += is_plain ? node.scalar : quoted(node.scalar);
      return;
    }
    case YamlNode::Kind::kList:
      out += '[';
      for (size_t i = 0; i < node.items.size(); ++i) {
        if (i > 0) out += ", ";
        write(node.items[i], out);
      }
      out += ']';
      return;
    case YamlNode::Kind::kMap:
      out += '{';
      for (size_t i = 0; i < node.entries.size(); ++i) {
        if (i > 0) out += ", ";
        out += node.entries[i].key + ": ";
        write(node.entries[i].value, out);
      }
      out += '}';
      return;
  }
}

void collect(YamlNode& node, std::vector<YamlNode*>& all) {
  for (YamlNode& item : node.items) {
    all.push_back(&item);
    collect(item, all);
  }
  for (YamlEntry& entry : node.entries) {
    all.push_back(&entry.value);
    collect(entry.value, all);
  }
}

/// Replaces the value of a field.
void replace_value(YamlNode& root, Draw& draw) {
  std::vector<YamlNode*> all;
  collect(root, all);
  YamlNode& node = *all[draw.below(all.size())];
  const size_t kind = draw.below(10);
  if (kind == 0) {
    node = YamlNode(*all[draw.below(all.size())]);  // value of another field
  } else if (kind < 5 && node.kind == YamlNode::Kind::kScalar &&
             std::isdigit(
                 static_cast<unsigned char>(node.scalar.empty() ? 0 : node.scalar.back()))) {
    // Another number, often a valid one.
    constexpr double kFactors[] = {-1, 0, 1e-6, 0.01, 0.1, 0.5, 0.99, 1.01, 2, 10, 1000, 1e7};
    const double value = std::strtod(node.scalar.c_str(), nullptr);
    node.scalar = kRaw + fmt::format("{:g}", value * kFactors[draw.below(std::size(kFactors))]);
  } else if (kind < 2 && node.kind == YamlNode::Kind::kScalar) {
    node.scalar = kRaw + std::string(1, "-+0.1e"[draw.below(6)]) + node.scalar;
  } else {
    node = YamlNode{};
    node.kind = YamlNode::Kind::kScalar;
    node.scalar = kRaw + extremes()[draw.below(extremes().size())];
  }
}

/// Removes, duplicates or renames a field or an item.
void change_shape(YamlNode& root, Draw& draw) {
  std::vector<YamlNode*> all{&root};
  collect(root, all);
  all.erase(
      std::remove_if(all.begin(), all.end(),
                     [](YamlNode* node) { return node->items.empty() && node->entries.empty(); }),
      all.end());
  YamlNode& node = *all[draw.below(all.size())];
  const size_t kind = draw.below(4);
  if (!node.items.empty()) {
    const size_t at = draw.below(node.items.size());
    if (kind < 2)
      node.items.erase(node.items.begin() + static_cast<ptrdiff_t>(at));
    else
      node.items.insert(node.items.begin(), kind == 2 ? 1 : 50, YamlNode(node.items[at]));
    return;
  }
  const size_t at = draw.below(node.entries.size());
  if (kind < 2)
    node.entries.erase(node.entries.begin() + static_cast<ptrdiff_t>(at));
  else if (kind == 2)
    node.entries.push_back(YamlEntry(node.entries[at]));
  else
    node.entries[at].key = extremes()[draw.below(extremes().size())];
}

std::vector<YamlNode> seeds() {
  const std::filesystem::path bundled = data_directory() / "scenes" / "bundled";
  const auto absolute = [&](std::string text, const std::string& from, const std::string& to) {
    for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  };
  std::vector<YamlNode> all;
  for (const SceneEntry& entry : bundled_scenes()) {
    std::string text = read_text_file(bundled / (entry.name + ".yaml"), kMaxYamlBytes);
    text = absolute(text, "obelisk.tri", (bundled / "obelisk.tri").string());
    text = absolute(text, "robot/robot.urdf", (bundled / "robot/robot.urdf").string());
    all.push_back(parse_yaml(text, entry.name));
  }
  for (const char* rich : kRich) {
    std::string text = absolute(rich, "MESH", (bundled / "obelisk.tri").string());
    text = absolute(text, "ROBOT", (bundled / "robot/robot.urdf").string());
    all.push_back(parse_yaml(text, "rich"));
  }
  return all;
}

/// Loads, describes and runs two frames of a few people.
void use(const std::filesystem::path& file, const std::shared_ptr<const Model>& cart) {
  Scene scene = load_scene(file.string());
  describe_scene(scene, navigation_mesh_of(scene));
  Scene scaled = scene;
  std::vector<std::string> notes;
  try {
    scale_to(scaled, 9, notes);
  } catch (const InputError&) {  // there are no people to scale
  }
  for (Group& group : scene.groups) {
    group.count = std::min(group.count, 2);
    for (Source& source : group.sources) source.count = std::min(source.count, 2);
    // Fitting the adult's gait takes most of a case; one in ten does.
    if (cart != nullptr && group.control_channel.empty() && group.model == adult_urdf())
      group.body = cart;
  }
  if (scene.box) scene.box->count = std::min(scene.box->count, 12);
  scene.duration_s = 2 * scene.step_s;
  Simulation simulation(std::move(scene), {});
  for (int i = 0; i < 2; ++i)
    for (const RootPose& root : simulation.step().roots)
      if (!root.position_m.allFinite() || !root.world_from_root.coeffs().allFinite())
        throw std::runtime_error("an avatar without a finite position");
  simulation.finish();
}

int run(const Arguments& arguments) {
  const Scratch scratch;
  const std::vector<YamlNode> sound = seeds();
  const std::shared_ptr<const Model> cart =
      load_model(data_directory() / "scenes" / "bundled" / "robot" / "robot.urdf");
  Tally tally;
  for (int64_t i = 0; i < arguments.count; ++i) {
    Draw draw(arguments.seed, static_cast<uint64_t>(i));
    YamlNode root = sound[static_cast<size_t>(i) % sound.size()];
    const size_t changes = 1 + draw.below(3) / 2;
    for (size_t k = 0; k < changes; ++k)
      draw.below(5) == 0 ? change_shape(root, draw) : replace_value(root, draw);
    std::string text;
    write(root, text);
    const std::filesystem::path file = scratch.write("scene.yaml", text);
    try_case(
        text, fmt::format("hostile_scene_{}_{}.yaml", arguments.seed, i),
        [&] { use(file, i % 10 == 9 ? nullptr : cart); }, tally);
  }
  return report("scenes", tally);
}

}  // namespace
}  // namespace throng::hostile

int main(int argc, char** argv) {
  return throng::hostile::run(throng::hostile::read_arguments(argc, argv, 10'000));
}
