#include "kinematics/urdf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

class Check {
 public:
  Check(const std::vector<XmlElement>& elements, const std::string& file)
      : elements_(elements), file_(file) {}

  void run() {
    check_root();
    for_children(0, [&](int child) {
      if (at(child).name == "link") add(child, links_, "link", kMaxLinks);
      if (at(child).name == "joint") add(child, joints_, "joint", kMaxLinks);
    });
    if (links_.empty()) fail(0, "at least one <link>", "none");
    for (const auto& [name, link] : links_) check_link(link);
    for (const auto& [name, joint] : joints_) check_joint(name, joint);
    for (const auto& [name, joint] : joints_) check_mimic(name, joint);
    check_tree();
  }

 private:
  using Named = std::map<std::string, int, std::less<>>;

  const XmlElement& at(int element) const { return elements_[static_cast<size_t>(element)]; }

  template <typename Use>
  void for_children(int parent, const Use& use) const {
    for (int child = at(parent).first_child; child >= 0; child = at(child).next_sibling) use(child);
  }

  [[noreturn]] void fail(int element, std::string_view expected, std::string_view found) const {
    throw InputError(at_line(file_, at(element).line), expected, found);
  }

  const std::string& required(int element, std::string_view attribute) const {
    const std::string* value = at(element).attribute(attribute);
    if (!value)
      fail(element, fmt::format("an attribute '{}' in <{}>", attribute, at(element).name), "none");
    return *value;
  }

  /// `count` finite numbers with absolute values up to `limit`.
  std::vector<double> numbers(int element, std::string_view attribute, size_t count,
                              double limit) const {
    const std::string& text = required(element, attribute);
    const auto found = finite_numbers(text);
    if (!found || found->size() != count)
      fail(element,
           count == 1 ? fmt::format("a finite number in {}=", attribute)
                      : fmt::format("{} finite numbers in {}=", count, attribute),
           in_quotes(text));
    for (const double number : *found)
      if (std::abs(number) > limit)
        fail(element, fmt::format("at most {:g} in {}=", limit, attribute), in_quotes(text));
    return *found;
  }

  double number_or(int element, std::string_view attribute, double fallback, double limit) const {
    return at(element).attribute(attribute) ? numbers(element, attribute, 1, limit)[0] : fallback;
  }

  void check_name(int element) const {
    const std::string& name = required(element, "name");
    const std::string expected = fmt::format("a name for this <{}>", at(element).name);
    const std::string defect = defect_of_name(name);
    if (!defect.empty()) fail(element, expected, defect);
  }

  void check_root() const {
    if (at(0).name != "robot")
      fail(0, "<robot> as the outermost tag", fmt::format("<{}>", at(0).name.substr(0, 60)));
    for (int i = 0; i < static_cast<int>(elements_.size()); ++i)
      if (at(i).name.substr(0, 6) == "xacro:")
        fail(i, "plain URDF",
             fmt::format("<{}>; expand it first: xacro FILE > robot.urdf",
                         at(i).name.substr(0, 60)));
    check_name(0);
  }

  void add(int element, Named& into, std::string_view what, int cap) const {
    check_name(element);
    const std::string& name = *at(element).attribute("name");
    const auto [entry, is_new] = into.emplace(name, element);
    if (!is_new)
      fail(element, fmt::format("each {} name once", what),
           fmt::format("{} again, first on line {}", in_quotes(name), at(entry->second).line));
    if (static_cast<int>(into.size()) > cap)
      fail(element, fmt::format("at most {} {}s", cap, what), "more");
  }

  void check_origin(int owner) const {
    const int origin = child_of(elements_, owner, "origin");
    if (origin < 0) return;
    if (at(origin).attribute("xyz")) numbers(origin, "xyz", 3, kMaxLength_m);
    if (at(origin).attribute("rpy")) numbers(origin, "rpy", 3, kMaxAngle_rad);
  }

  void check_link(int link) {
    for_children(link, [&](int child) {
      const std::string_view name = at(child).name;
      if (name == "visual" || name == "collision") {
        if (++shapes_ > kMaxShapes)
          fail(child, fmt::format("at most {} shapes", kMaxShapes), "more");
        check_shape(child);
      }
      if (name == "inertial") check_inertial(child);
    });
  }

  void check_inertial(int inertial) const {
    check_origin(inertial);
    const int mass = child_of(elements_, inertial, "mass");
    if (mass < 0) fail(inertial, "<mass value=...> in <inertial>", "none");
    constexpr double kAnyMass = 1e9;
    if (numbers(mass, "value", 1, kAnyMass)[0] < 0)
      fail(mass, "a mass that is not negative", in_quotes(required(mass, "value")));
    const int inertia = child_of(elements_, inertial, "inertia");
    if (inertia < 0) fail(inertial, "<inertia ixx=...> in <inertial>", "none");
    for (const char* name : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
      numbers(inertia, name, 1, HUGE_VAL);
  }

  void positive(int element, std::string_view attribute, size_t count) const {
    const auto sizes = numbers(element, attribute, count, kMaxLength_m);
    // A float has to hold it and its square, so that no volume computed from it is empty.
    if (std::any_of(sizes.begin(), sizes.end(), [](double size) { return size < 1e-9; }))
      fail(element, fmt::format("a positive {} of <{}>", attribute, at(element).name),
           in_quotes(required(element, attribute)));
  }

  void check_shape(int owner) const {
    check_origin(owner);
    const int geometry = child_of(elements_, owner, "geometry");
    const int shape = geometry < 0 ? -1 : at(geometry).first_child;
    if (shape < 0)
      fail(owner, fmt::format("<geometry> with a shape in <{}>", at(owner).name), "none");
    const std::string_view kind = at(shape).name;
    if (kind == "box") {
      positive(shape, "size", 3);
    } else if (kind == "sphere") {
      positive(shape, "radius", 1);
    } else if (kind == "cylinder") {
      positive(shape, "radius", 1);
      positive(shape, "length", 1);
    } else if (kind == "mesh") {
      if (required(shape, "filename").empty())
        fail(shape, "a file name for this <mesh>", "an empty one");
      if (at(shape).attribute("scale"))
        for (const double scale : numbers(shape, "scale", 3, kMaxMeshScale))
          if (std::abs(scale) < 1 / kMaxMeshScale)
            fail(shape, "a mesh scale that is not zero", in_quotes(required(shape, "scale")));
    } else {
      fail(shape, "<mesh>, <box>, <cylinder> or <sphere>", fmt::format("<{}>", kind.substr(0, 60)));
    }
  }

  std::string kind_of(int joint) const {
    const std::string& type = required(joint, "type");
    if (type == "floating" || type == "planar")
      fail(joint, "fixed, revolute, continuous or prismatic joints",
           fmt::format("{}: it has several degrees of freedom; the root link moves freely already, "
                       "and elsewhere a chain of single joints says the same",
                       in_quotes(type)));
    static const std::vector<std::string> known{"fixed", "revolute", "continuous", "prismatic"};
    if (std::find(known.begin(), known.end(), type) == known.end())
      fail(joint, "a joint type fixed, revolute, continuous or prismatic",
           in_quotes(type) + did_you_mean(type, known));
    return type;
  }

  int end_of(int joint, std::string_view end) const {
    const int element = child_of(elements_, joint, end);
    if (element < 0) fail(joint, fmt::format("<{} link=...> in <joint>", end), "none");
    const std::string& name = required(element, "link");
    const auto link = links_.find(name);
    if (link == links_.end())
      fail(element, "the name of a <link>", in_quotes(name) + near(name, links_));
    return link->second;
  }

  static std::string near(std::string_view name, const Named& known) {
    std::vector<std::string> names;
    for (const auto& [known_name, element] : known) names.push_back(known_name);
    return did_you_mean(name, names);
  }

  void check_joint(const std::string& name, int joint) {
    const std::string kind = kind_of(joint);
    check_origin(joint);
    const int parent = end_of(joint, "parent");
    const int child = end_of(joint, "child");
    if (parent == child)
      fail(joint, "a joint between two links",
           fmt::format("{} ties a link to itself", in_quotes(name)));
    const auto [entry, is_new] = joint_above_.emplace(child, joint);
    if (!is_new)
      fail(std::max(joint, entry->second), "one parent for each link",
           fmt::format("two for {}: joints {} and {}", in_quotes(*at(child).attribute("name")),
                       in_quotes(*at(entry->second).attribute("name")), in_quotes(name)));
    parent_link_[child] = parent;
    if (const int axis = child_of(elements_, joint, "axis"); axis >= 0 && kind != "fixed") {
      const auto xyz = numbers(axis, "xyz", 3, 1e6);
      if (std::hypot(xyz[0], xyz[1], xyz[2]) < 1e-6)
        fail(axis, "a joint axis that is not zero", in_quotes(required(axis, "xyz")));
    }
    check_limit(joint, kind);
  }

  void check_limit(int joint, const std::string& kind) const {
    const int limit = child_of(elements_, joint, "limit");
    const bool needs_limit = kind == "revolute" || kind == "prismatic";
    if (limit < 0 && needs_limit)
      fail(joint, fmt::format("<limit lower=... upper=...> for a {} joint", kind), "none");
    if (limit < 0) return;
    for (const char* name : {"effort", "velocity"}) numbers(limit, name, 1, HUGE_VAL);
    const double most = kind == "prismatic" ? kMaxLength_m : kMaxAngle_rad;
    const double lower = number_or(limit, "lower", 0, needs_limit ? most : HUGE_VAL);
    const double upper = number_or(limit, "upper", 0, needs_limit ? most : HUGE_VAL);
    if (needs_limit && lower > upper)
      fail(limit, "lower <= upper", fmt::format("lower {:g}, upper {:g}", lower, upper));
  }

  void check_mimic(const std::string& name, int joint) const {
    int mimic = child_of(elements_, joint, "mimic");
    if (mimic < 0 || kind_of(joint) == "fixed") return;
    for (const char* factor : {"multiplier", "offset"}) number_or(mimic, factor, 0, kMaxLength_m);
    // Follows the leaders; more steps than joints means that they run in a circle.
    for (size_t steps = 0; mimic >= 0; ++steps) {
      const std::string& leader = required(mimic, "joint");
      const auto entry = joints_.find(leader);
      if (entry == joints_.end())
        fail(mimic, "the name of a <joint> to mimic", in_quotes(leader) + near(leader, joints_));
      if (kind_of(entry->second) == "fixed")
        fail(mimic, "a joint that moves to mimic",
             fmt::format("{}, which is fixed", in_quotes(leader)));
      if (steps > joints_.size() || leader == name)
        fail(child_of(elements_, joint, "mimic"), "a mimic chain that ends at a free joint",
             fmt::format("a circle through {}", in_quotes(name)));
      mimic = child_of(elements_, entry->second, "mimic");
    }
  }

  void check_tree() const {
    int root = -1;
    for (const auto& [name, link] : links_) {
      if (joint_above_.count(link) != 0) continue;
      if (root >= 0)
        fail(
            std::max(root, link), "one root link",
            fmt::format("two: {} and {}", in_quotes(*at(root).attribute("name")), in_quotes(name)));
      root = link;
    }
    if (root < 0) fail(0, "a root link", "none: the joints form a loop");
    for (const auto& [name, link] : links_) {
      int depth = 0;
      for (int up = link; up != root; up = parent_link_.at(up))
        // A loop is longer than any chain, so this names it unless there are more links than that.
        if (++depth > static_cast<int>(links_.size()))
          fail(link,
               fmt::format("every link below the root {}", in_quotes(*at(root).attribute("name"))),
               fmt::format("a loop of joints above {}", in_quotes(name)));
      if (depth > kMaxChainDepth)
        fail(link, fmt::format("chains of at most {} joints", kMaxChainDepth),
             fmt::format("{} above {}", depth, in_quotes(name)));
    }
  }

  const std::vector<XmlElement>& elements_;
  const std::string& file_;
  Named links_;
  Named joints_;
  int shapes_ = 0;
  std::map<int, int> joint_above_;
  std::map<int, int> parent_link_;
};

struct Use {
  std::string_view tag;
  std::string_view note;  ///< empty: used, or told under its owner
};

constexpr std::array kKnownTags{
    Use{"link", ""},
    Use{"joint", ""},
    Use{"origin", ""},
    Use{"parent", ""},
    Use{"child", ""},
    Use{"axis", ""},
    Use{"limit", ""},
    Use{"mimic", ""},
    Use{"visual", ""},
    Use{"collision", ""},
    Use{"geometry", ""},
    Use{"mesh", ""},
    Use{"box", ""},
    Use{"cylinder", ""},
    Use{"sphere", ""},
    Use{"mass", ""},
    Use{"inertial", "the mass is read, the inertia is not used"},
    Use{"inertia", ""},
    Use{"material", "colours and textures are not used"},
    Use{"dynamics", "friction and damping are not used"},
    Use{"calibration", "not used"},
    Use{"safety_controller", "soft limits are not used, <limit> is"},
    Use{"transmission", "drives are not simulated"},
    Use{"gazebo", "extensions for Gazebo are not used"},
    Use{"ros2_control", "controllers are not used"},
    Use{"sensor", "sensors are not simulated"},
};

}  // namespace

std::optional<std::vector<double>> finite_numbers(std::string_view text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (;;) {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r')) ++at;
    if (at == end) return numbers;
    if (*at == '+') ++at;
    double number = 0;
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc{} || !std::isfinite(number)) return std::nullopt;
    if (next != end && *next != ' ' && *next != '\t' && *next != '\n' && *next != '\r')
      return std::nullopt;
    numbers.push_back(number);
    at = next;
  }
}

void check_urdf(const std::vector<XmlElement>& elements, const std::string& file) {
  Check(elements, file).run();
}

std::vector<std::string> unused_in_urdf(const std::vector<XmlElement>& elements) {
  std::map<std::string, std::pair<int, std::string_view>> counts;
  std::vector<bool> told(elements.size(), false);  // an unused tag speaks for all inside it
  for (size_t i = 1; i < elements.size(); ++i) {
    const size_t parent = static_cast<size_t>(elements[i].parent);
    told[i] = told[parent];
    if (told[i]) continue;
    const auto* known = std::find_if(kKnownTags.begin(), kKnownTags.end(),
                                     [&](const Use& use) { return use.tag == elements[i].name; });
    if (known != kKnownTags.end() && known->note.empty()) continue;
    const bool understood = known != kKnownTags.end();
    told[i] = elements[i].name != "inertial";
    const std::string key = fmt::format("<{}>", escaped(elements[i].name.substr(0, 60)));
    auto& entry = counts.emplace(key, std::pair{0, understood ? known->note : "not understood"})
                      .first->second;
    ++entry.first;
  }
  constexpr size_t kMostTags = 60;  // a page; the rest is a number
  std::vector<std::string> notes;
  for (const auto& [tag, count] : counts) {
    if (notes.size() == kMostTags) {
      notes.push_back(fmt::format("and {} more tags: not understood", counts.size() - kMostTags));
      break;
    }
    notes.push_back(fmt::format("{} x{}: {}", tag, count.first, count.second));
  }
  return notes;
}

}  // namespace throng
