#include "kinematics/urdf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "kinematics/mesh_path.h"

namespace throng {
namespace {

class Check {
 public:
  Check(const std::vector<XmlElement>& elements, const std::string& file)
      : elements_(elements), file_(file) {
    use_.skipped.resize(elements.size());
  }

  UrdfCheckResult run() {
    check_root();
    reject_xacro(elements_, file_);
    for_children(0, [&](int child) {
      if (at(child).name == "link") add(child, links_, "link", kMaxLinks);
      if (at(child).name == "joint") add(child, joints_, "joint", kMaxLinks);
    });
    if (links_.empty()) fail(0, "at least one <link>", "none");
    cut_at_free_joints();
    for (const auto& [name, link] : links_) check_link(name, link);
    for (const auto& [name, joint] : joints_) check_joint(name, joint);
    for (const auto& [name, joint] : joints_) check_mimic(name, joint);
    check_tree();
    list_assumptions();
    return std::move(use_);
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

  /// Returns `count` finite numbers with absolute values up to `limit`.
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
  }

  const std::string& link_name(int link) const { return *at(link).attribute("name"); }

  bool has_shape(int link) const {
    return child_of(elements_, link, "visual") >= 0 || child_of(elements_, link, "collision") >= 0;
  }

  /// Returns the <link> of the robot that <parent> or <child> names, or -1.
  int named_end(int joint, std::string_view end) const {
    const int element = child_of(elements_, joint, end);
    const std::string* name = element < 0 ? nullptr : at(element).attribute("link");
    const auto link = name == nullptr ? links_.end() : links_.find(*name);
    return link == links_.end() ? -1 : link->second;
  }

  bool is_free(int joint) const {
    const std::string* type = at(joint).attribute("type");
    return type != nullptr && (*type == "floating" || *type == "planar");
  }

  std::set<int> links_below(int link, const std::map<int, std::vector<int>>& children) const {
    std::set<int> below{link};
    std::vector<int> pending{link};
    while (!pending.empty()) {
      const auto next = children.find(pending.back());
      pending.pop_back();
      if (next == children.end()) continue;
      for (const int child : next->second)
        if (below.insert(child).second) pending.push_back(child);
    }
    return below;
  }

  /// Cuts off a fixed frame above a free joint. An avatar's root moves freely; hence a joint of
  /// several degrees of freedom between a world frame and the robot adds nothing. The robot is the
  /// side below, if the other side has no shape. Likewise a side below without shapes is cut off.
  void cut_at_free_joints() {
    std::map<int, std::vector<int>> children;
    std::vector<int> free;
    for (const auto& [name, joint] : joints_) {
      const int parent = named_end(joint, "parent");
      const int child = named_end(joint, "child");
      if (parent < 0 || child < 0) continue;
      children[parent].push_back(child);
      if (is_free(joint)) free.push_back(joint);
    }
    std::sort(free.begin(), free.end());
    for (const int joint : free) {
      if (use_.skipped[static_cast<size_t>(joint)]) continue;
      const std::set<int> below = links_below(named_end(joint, "child"), children);
      if (below.count(named_end(joint, "parent")) != 0) continue;  // a loop, rejected later
      size_t shapes_below = 0;
      size_t shapes_elsewhere = 0;
      for (const auto& [name, link] : links_)
        if (has_shape(link)) ++(below.count(link) != 0 ? shapes_below : shapes_elsewhere);
      if ((shapes_below > 0) == (shapes_elsewhere > 0)) continue;
      keep_one_side(joint, below, shapes_below > 0);
    }
  }

  void keep_one_side(int joint, const std::set<int>& below, bool keeps_below) {
    for (const auto& [name, other] :
         joints_) {  // a second joint between both sides: rejected later
      const bool is_below = below.count(named_end(other, "parent")) != 0;
      if (other != joint && is_below != (below.count(named_end(other, "child")) != 0)) return;
    }
    const std::string base = in_quotes(link_name(named_end(joint, "child")));
    use_.notes.push_back(fmt::format(
        "joint {} of type {}, line {}: skipped with all links {}, none of which has a shape{}",
        in_quotes(*at(joint).attribute("name")), in_quotes(*at(joint).attribute("type")),
        at(joint).line, keeps_below ? "above " + base : "from " + base + " on",
        keeps_below ? "; the robot's root is " + base + ", and moves freely" : ""));
    const auto skip = [&](int element) { use_.skipped[static_cast<size_t>(element)] = true; };
    const auto goes = [&](int link) { return (below.count(link) != 0) != keeps_below; };
    skip(joint);
    for (const auto& [name, other] : joints_)
      if (other != joint && named_end(other, "child") >= 0 && goes(named_end(other, "child")))
        skip(other);
    std::erase_if(joints_, [&](const auto& entry) {
      return use_.skipped[static_cast<size_t>(entry.second)];
    });
    for (const auto& [name, link] : links_)
      if (goes(link)) skip(link);
    std::erase_if(
        links_, [&](const auto& entry) { return use_.skipped[static_cast<size_t>(entry.second)]; });
  }

  void add(int element, Named& into, std::string_view what, int cap) const {
    check_name(element);
    const std::string& name = *at(element).attribute("name");
    const auto [entry, is_new] = into.emplace(name, element);
    if (!is_new)
      fail(element, fmt::format("unique {} names", what),
           fmt::format("{} again, first on line {}", in_quotes(name), at(entry->second).line));
    if (static_cast<int>(into.size()) > cap)
      fail(element, fmt::format("at most {} {}s", cap, what), "more");
  }

  void check_origin(int owner) const {
    const int origin = child_of(elements_, owner, "origin");
    if (origin < 0) return;
    if (at(origin).attribute("xyz")) numbers(origin, "xyz", 3, kMaxLength_m);
    const bool turns = at(origin).attribute("rpy") != nullptr;
    if (turns) numbers(origin, "rpy", 3, kMaxAngle_rad);
    if (!at(origin).attribute("quat_xyzw")) return;
    if (turns) fail(origin, "rpy= or quat_xyzw= in <origin>", "both");
    const auto q = numbers(origin, "quat_xyzw", 4, 1e6);
    if (std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) < 1e-6)
      fail(origin,
           "a quaternion that is not zero in quat_xyzw=", in_quotes(required(origin, "quat_xyzw")));
  }

  void check_link(const std::string& name, int link) {
    const bool has_collision = child_of(elements_, link, "collision") >= 0;
    for_children(link, [&](int child) {
      const std::string_view tag = at(child).name;
      if (tag == "visual" || tag == "collision") {
        if (++shapes_ > kMaxShapes)
          fail(child, fmt::format("at most {} shapes", kMaxShapes), "more");
        if (tag == "visual" && has_collision)
          skip_unsound(name, child);
        else
          check_shape(child);
      }
      if (tag == "inertial") check_inertial(child);
    });
  }

  /// Checks a <visual> that is not used because of <collision>; a defect of it is only noted.
  void skip_unsound(const std::string& link, int visual) {
    try {
      check_shape(visual);
    } catch (const InputError& error) {
      use_.skipped[static_cast<size_t>(visual)] = true;
      constexpr size_t kMaxNotes = 40;  // one page
      if (++unsound_visuals_ > kMaxNotes) return;
      use_.notes.push_back(fmt::format(
          "<visual> of link {}, line {}: skipped in favour of <collision>: {}", in_quotes(link),
          at(visual).line, std::string(error.what()).substr(error.where().size() + 2)));
    }
  }

  void check_inertial(int inertial) const {
    const int mass = child_of(elements_, inertial, "mass");
    if (mass < 0) return;
    constexpr double kAnyMass = 1e9;
    if (numbers(mass, "value", 1, kAnyMass)[0] < 0)
      fail(mass, "a mass that is not negative", in_quotes(required(mass, "value")));
  }

  void positive(int element, std::string_view attribute, size_t count) const {
    const auto sizes = numbers(element, attribute, count, kMaxLength_m);
    // A float must represent it and its square; otherwise volumes computed from it are empty.
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
    } else if (kind == "capsule") {
      positive(shape, "radius", 1);
      if (numbers(shape, "length", 1, kMaxLength_m)[0] < 0)  // at 0 it is a sphere
        fail(shape, "a length of <capsule> that is not negative",
             in_quotes(required(shape, "length")));
    } else if (kind == "mesh") {
      const std::string& uri = required(shape, "filename");
      if (uri.find_first_not_of(' ') == std::string::npos)
        fail(shape, "a file name for this <mesh>", "an empty one");
      if (!is_mesh_uri(uri))
        fail(shape, "a mesh path, file://, package:// or model://", in_quotes(uri));
      if (at(shape).attribute("scale"))
        for (const double scale : numbers(shape, "scale", 3, kMaxMeshScale))
          if (std::abs(scale) < 1 / kMaxMeshScale)
            fail(shape, "a mesh scale that is not zero", in_quotes(required(shape, "scale")));
    } else {
      fail(shape, "<mesh>, <box>, <cylinder>, <sphere> or <capsule>",
           fmt::format("<{}>", kind.substr(0, 60)));
    }
  }

  std::string kind_of(int joint) const {
    const std::string& type = required(joint, "type");
    if (type == "floating" || type == "planar")
      fail(joint, "fixed, revolute, continuous or prismatic joints",
           fmt::format("{}: it has several degrees of freedom; omit it at the root link, which "
                       "moves freely, "
                       "and elsewhere use a chain of single joints",
                       in_quotes(type)));
    static const std::vector<std::string> known{"fixed", "revolute", "continuous", "prismatic",
                                                "spherical"};
    if (std::find(known.begin(), known.end(), type) == known.end())
      fail(joint, "a joint type fixed, revolute, continuous, prismatic or spherical",
           in_quotes(type) + did_you_mean(type, known));
    return type;
  }

  int end_of(int joint, std::string_view end) const {
    const int element = child_of(elements_, joint, end);
    if (element < 0) fail(joint, fmt::format("<{} link=...> in <joint>", end), "none");
    const std::string& name = required(element, "link");
    const auto link = links_.find(name);
    if (link == links_.end())
      fail(element, "the name of a <link>", in_quotes(name) + suggestion(name, links_));
    return link->second;
  }

  static std::string suggestion(std::string_view name, const Named& known) {
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
    if (const int axis = child_of(elements_, joint, "axis");
        axis >= 0 && kind != "fixed" && kind != "spherical") {
      const auto xyz = numbers(axis, "xyz", 3, 1e6);
      if (std::hypot(xyz[0], xyz[1], xyz[2]) < 1e-6)
        fail(axis, "a joint axis that is not zero", in_quotes(required(axis, "xyz")));
    }
    if (kind == "spherical") add_spherical(name, joint);
    if (kind == "revolute" || kind == "prismatic") check_limit(name, joint, kind);
  }

  /// A spherical joint becomes three joints and two more links with longer names.
  void add_spherical(const std::string& name, int joint) {
    constexpr size_t kMaxBytes = kMaxNameBytes - 8;
    if (name.size() > kMaxBytes)
      fail(joint, fmt::format("a name of at most {} bytes for a spherical joint", kMaxBytes),
           fmt::format("one of {}", name.size()));
    spherical_.emplace(joint, name);
    if (links_.size() + 2 * spherical_.size() > static_cast<size_t>(kMaxLinks))
      fail(joint, fmt::format("at most {} links, two more for each spherical joint", kMaxLinks),
           "more");
  }

  /// The leader determines the range of a joint that mimics another.
  bool follows(int joint) const { return child_of(elements_, joint, "mimic") >= 0; }

  void check_limit(const std::string& name, int joint, const std::string& kind) {
    const int limit = child_of(elements_, joint, "limit");
    if (limit < 0) {
      if (!follows(joint)) (kind == "revolute" ? unlimited_ : fixed_).emplace(joint, name);
      return;
    }
    const double max_value = kind == "prismatic" ? kMaxLength_m : kMaxAngle_rad;
    const double lower = number_or(limit, "lower", 0, max_value);
    const double upper = number_or(limit, "upper", 0, max_value);
    if (lower > upper)
      fail(limit, "lower <= upper", fmt::format("lower {:g}, upper {:g}", lower, upper));
    if (!at(limit).attribute("lower") && !at(limit).attribute("upper") && !follows(joint))
      stuck_.emplace(joint, name);
  }

  void assume(const std::map<int, std::string>& joints, std::string_view what) {
    if (joints.empty()) return;
    constexpr size_t kMaxNames = 4;
    std::string names;
    size_t count = 0;
    for (const auto& [joint, name] : joints)
      if (++count <= kMaxNames)
        names +=
            fmt::format("{}{} (line {})", count > 1 ? ", " : "", in_quotes(name), at(joint).line);
    if (count > kMaxNames) names += fmt::format(" and {} more", count - kMaxNames);
    use_.assumptions.push_back(fmt::format("{}: {}", what, names));
  }

  void list_assumptions() {
    assume(spherical_, "spherical joints are read as three continuous ones, about x, y and z");
    assume(unlimited_, "revolute joints without <limit> are read as continuous ones");
    assume(fixed_, "prismatic joints without <limit> stay at 0 m");
    assume(stuck_, "joints without lower and upper in <limit> do not move, because both are 0");
  }

  bool is_of_one_number(int joint) const {
    const std::string kind = kind_of(joint);
    return kind != "fixed" && kind != "spherical";
  }

  void check_mimic(const std::string& name, int joint) const {
    int mimic = child_of(elements_, joint, "mimic");
    if (mimic < 0 || !is_of_one_number(joint)) return;
    for (const char* factor : {"multiplier", "offset"}) number_or(mimic, factor, 0, kMaxLength_m);
    // Follows the leaders; more steps than joints mean a cycle.
    for (size_t steps = 0; mimic >= 0; ++steps) {
      const std::string& leader = required(mimic, "joint");
      const auto entry = joints_.find(leader);
      if (entry == joints_.end())
        fail(mimic, "the name of a <joint> to mimic",
             in_quotes(leader) + suggestion(leader, joints_));
      if (!is_of_one_number(entry->second))
        fail(mimic, "a joint that moves to mimic",
             fmt::format("{}, which is {}", in_quotes(leader), kind_of(entry->second)));
      if (steps > joints_.size() || leader == name)
        fail(child_of(elements_, joint, "mimic"), "a mimic chain that ends at a free joint",
             fmt::format("a cycle through {}", in_quotes(name)));
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
      size_t steps = 0;
      for (int up = link; up != root; up = parent_link_.at(up)) {
        depth += spherical_.count(joint_above_.at(up)) != 0 ? 3 : 1;
        // A loop exceeds any chain, and is reported as such.
        if (++steps > links_.size())
          fail(link,
               fmt::format("every link below the root {}", in_quotes(*at(root).attribute("name"))),
               fmt::format("a loop of joints above {}", in_quotes(name)));
      }
      if (depth > kMaxChainDepth)
        fail(link, fmt::format("chains of at most {} joints", kMaxChainDepth),
             fmt::format("{} above {}", depth, in_quotes(name)));
    }
  }

  const std::vector<XmlElement>& elements_;
  const std::string& file_;
  Named links_;
  Named joints_;
  UrdfCheckResult use_;
  int shapes_ = 0;
  size_t unsound_visuals_ = 0;
  std::map<int, std::string> unlimited_, fixed_, stuck_, spherical_;  ///< joints by element
  std::map<int, int> joint_above_;
  std::map<int, int> parent_link_;
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

UrdfCheckResult check_urdf(const std::vector<XmlElement>& elements, const std::string& file) {
  return Check(elements, file).run();
}

namespace {

[[noreturn]] void reject(const XmlElement& element, const std::string& file,
                         const std::string& found) {
  throw InputError(at_line(file, element.line), "plain URDF",
                   found + "; expand it first: xacro FILE > robot.urdf");
}

std::vector<std::string> prefixes_of(const XmlElement& robot) {
  std::vector<std::string> prefixes{"xacro:"};
  for (const auto& [attribute, value] : robot.attributes)
    if (attribute.starts_with("xmlns:") && value.find("ros.org/wiki/xacro") != std::string::npos)
      prefixes.push_back(std::string(attribute.substr(6)) + ":");
  return prefixes;
}

bool is_substitution(const std::string& value, std::string_view open, char close) {
  const size_t begin = value.find(open);
  return begin != std::string::npos && value.find(close, begin) != std::string::npos;
}

struct Use {
  std::string_view tag;
  std::string_view note;  ///< empty: used, or reported with the parent tag
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
    Use{"capsule", ""},
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

void reject_xacro(const std::vector<XmlElement>& elements, const std::string& file) {
  const std::vector<std::string> prefixes = prefixes_of(elements[0]);
  std::vector<bool> is_used(elements.size(), false);
  is_used[0] = true;
  for (size_t i = 0; i < elements.size(); ++i) {
    const std::string_view name = elements[i].name;
    for (const std::string& prefix : prefixes)
      if (name.starts_with(prefix))
        reject(elements[i], file, fmt::format("<{}>", escaped(name.substr(0, 60))));
    if (i > 0)
      is_used[i] = elements[i].parent == 0 ? name == "link" || name == "joint"
                                           : is_used[static_cast<size_t>(elements[i].parent)];
    if (!is_used[i]) continue;
    for (const auto& [attribute, value] : elements[i].attributes)
      if (is_substitution(value, "${", '}') || is_substitution(value, "$(", ')'))
        reject(elements[i], file,
               fmt::format("{}={}", escaped(attribute.substr(0, 60)), in_quotes(value)));
  }
}

std::vector<std::string> unused_in_urdf(const std::vector<XmlElement>& elements) {
  std::map<std::string, std::pair<int, std::string_view>> counts;
  std::vector<bool> is_reported(elements.size(), false);  // an unused tag covers those inside it
  for (size_t i = 1; i < elements.size(); ++i) {
    const size_t parent = static_cast<size_t>(elements[i].parent);
    is_reported[i] = is_reported[parent];
    if (is_reported[i]) continue;
    const auto* known = std::find_if(kKnownTags.begin(), kKnownTags.end(),
                                     [&](const Use& use) { return use.tag == elements[i].name; });
    if (known != kKnownTags.end() && known->note.empty()) continue;
    const bool understood = known != kKnownTags.end();
    is_reported[i] = elements[i].name != "inertial";
    const std::string key = fmt::format("<{}>", escaped(elements[i].name.substr(0, 60)));
    auto& entry = counts.emplace(key, std::pair{0, understood ? known->note : "not understood"})
                      .first->second;
    ++entry.first;
  }
  constexpr size_t kMaxTags = 60;  // one page; the rest is counted
  std::vector<std::string> notes;
  for (const auto& [tag, count] : counts) {
    if (notes.size() == kMaxTags) {
      notes.push_back(fmt::format("and {} more tags: not understood", counts.size() - kMaxTags));
      break;
    }
    notes.push_back(fmt::format("{} x{}: {}", tag, count.first, count.second));
  }
  return notes;
}

}  // namespace throng
