#include "kinematics/plain_urdf.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string_view>

#include "kinematics/urdf_check.h"

namespace throng {
namespace {

std::string in_xml(std::string_view value) {
  std::string out;
  for (const char c : value) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

class Writer {
 public:
  Writer(const std::vector<XmlElement>& elements, const UrdfCheckResult& use)
      : elements_(elements), use_(use) {}

  std::string text() {
    out_ = "<robot name=\"robot\">\n";
    for (int i = at(0).first_child; i >= 0; i = at(i).next_sibling) {
      if (use_.skipped[static_cast<size_t>(i)]) continue;
      if (at(i).name == "link") write_link(i);
      if (at(i).name == "joint") write_joint(i);
    }
    return std::move(out_) + "</robot>\n";
  }

 private:
  const XmlElement& at(int element) const { return elements_[static_cast<size_t>(element)]; }

  void open(std::string_view tag, int element, std::initializer_list<std::string_view> attributes,
            std::string_view more = "") {
    out_ += fmt::format("<{}", tag);
    for (const std::string_view attribute : attributes)
      if (const std::string* value = at(element).attribute(attribute))
        out_ += fmt::format(" {}=\"{}\"", attribute, in_xml(*value));
    out_ += fmt::format("{}>", more);
  }

  void write_child(int element, std::string_view tag,
                   std::initializer_list<std::string_view> attributes, std::string_view more = "") {
    const int child = child_of(elements_, element, tag);
    if (child >= 0) open(tag, child, attributes, fmt::format("{}/", more));
  }

  void write_link(int link) {
    open("link", link, {"name"});
    for (int i = at(link).first_child; i >= 0; i = at(i).next_sibling)
      if ((at(i).name == "visual" || at(i).name == "collision") &&
          !use_.skipped[static_cast<size_t>(i)])
        write_shape(i);
    out_ += "</link>\n";
  }

  void write_shape(int owner) {
    out_ += fmt::format("<{}>", at(owner).name);
    write_child(owner, "origin", {"xyz", "rpy"});
    const int shape = at(child_of(elements_, owner, "geometry")).first_child;
    out_ += "<geometry>";
    open(at(shape).name == "capsule" ? "cylinder" : at(shape).name, shape,
         {"size", "radius", "length", "filename", "scale"}, "/");
    out_ += fmt::format("</geometry></{}>\n", at(owner).name);
  }

  void write_joint(int joint) {
    const std::string& given = *at(joint).attribute("type");
    const std::string type = given == "spherical" ? "fixed" : given;
    const bool has_limit = child_of(elements_, joint, "limit") >= 0;
    out_ += fmt::format("<joint name=\"{}\" type=\"{}\">", in_xml(*at(joint).attribute("name")),
                        type == "revolute" && !has_limit ? "continuous" : type);
    write_child(joint, "parent", {"link"});
    write_child(joint, "child", {"link"});
    write_child(joint, "origin", {"xyz", "rpy"});
    if (type != "fixed") {
      write_child(joint, "axis", {"xyz"});
      write_child(joint, "mimic", {"joint", "multiplier", "offset"});
    }
    // urdfdom requires all four, Throng uses two.
    constexpr std::string_view kForces = " effort=\"0\" velocity=\"0\"";
    if (type == "revolute" || type == "prismatic") {
      write_child(joint, "limit", {"lower", "upper"}, kForces);
      if (!has_limit && type == "prismatic") out_ += fmt::format("<limit{}/>", kForces);
    }
    out_ += "</joint>\n";
  }

  const std::vector<XmlElement>& elements_;
  const UrdfCheckResult& use_;
  std::string out_;
};

}  // namespace

std::string plain_urdf(const std::vector<XmlElement>& elements, const UrdfCheckResult& use) {
  return Writer(elements, use).text();
}

namespace {

/// One page; further notes are only counted.
constexpr size_t kMaxIgnoredNotes = 40;

class IgnoredTags {
 public:
  explicit IgnoredTags(const std::vector<XmlElement>& elements) : elements_(elements) {}

  /// Returns why a child of a link can be ignored, or "".
  std::string reason_for(int child) const {
    const std::string_view name = at(child).name;
    if (name == "visual" || name == "collision") return without_surface(child);
    if (name == "inertial" && is_incomplete(child)) return "incomplete, and not used";
    return "";
  }

 private:
  const XmlElement& at(int element) const { return elements_[static_cast<size_t>(element)]; }

  /// Returns how many of the sizes in an attribute are above 0, or nothing if they are malformed.
  std::optional<size_t> sizes_above_zero(int shape, std::string_view attribute,
                                         size_t count) const {
    const std::string* text = at(shape).attribute(attribute);
    const auto sizes = text == nullptr ? std::nullopt : finite_numbers(*text);
    if (!sizes || sizes->size() != count) return std::nullopt;
    if (std::any_of(sizes->begin(), sizes->end(), [](double size) { return size < 0; }))
      return std::nullopt;
    return static_cast<size_t>(
        std::count_if(sizes->begin(), sizes->end(), [](double size) { return size > 0; }));
  }

  std::string without_surface(int owner) const {
    const int geometry = child_of(elements_, owner, "geometry");
    const int shape = geometry < 0 ? -1 : at(geometry).first_child;
    if (shape < 0) return "";
    const std::string_view kind = at(shape).name;
    bool is_ignored = false;
    if (kind == "box") {
      const auto edges = sizes_above_zero(shape, "size", 3);
      is_ignored = edges && *edges < 2;  // a plate has a surface, a line has none
    } else if (kind == "sphere") {
      is_ignored = sizes_above_zero(shape, "radius", 1) == size_t{0};
    } else if (kind == "cylinder" || kind == "capsule") {
      is_ignored = sizes_above_zero(shape, "radius", 1) == size_t{0} &&
                   sizes_above_zero(shape, "length", 1).has_value();
    }
    return is_ignored ? fmt::format("a {} of size zero, which touches nothing", kind) : "";
  }

  bool is_incomplete(int inertial) const {
    const int mass = child_of(elements_, inertial, "mass");
    const int inertia = child_of(elements_, inertial, "inertia");
    if (mass < 0 || inertia < 0 || at(mass).attribute("value") == nullptr) return true;
    for (const char* name : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
      if (at(inertia).attribute(name) == nullptr) return true;
    return false;
  }

  const std::vector<XmlElement>& elements_;
};

}  // namespace

std::string blank_ignored_tags(const std::string& text, const std::vector<XmlElement>& elements,
                               std::vector<std::string>& notes) {
  std::string out = text;
  const IgnoredTags ignored(elements);
  size_t left_out = 0;
  for (size_t i = 1; i < elements.size(); ++i) {
    const XmlElement& element = elements[i];
    if (element.parent < 0) continue;
    const XmlElement& owner = elements[static_cast<size_t>(element.parent)];
    if (owner.parent != 0 || owner.name != "link") continue;
    const std::string reason = ignored.reason_for(static_cast<int>(i));
    if (reason.empty()) continue;
    const auto begin = static_cast<size_t>(element.name.data() - text.data()) - 1;
    for (size_t k = begin; k < element.end; ++k)
      if (out[k] != '\n') out[k] = ' ';
    if (++left_out > kMaxIgnoredNotes) continue;
    const std::string* name = owner.attribute("name");
    notes.push_back(fmt::format("<{}> of link '{}', line {}: skipped: {}", element.name,
                                name == nullptr ? "" : name->substr(0, kMaxNameBytes), element.line,
                                reason));
  }
  if (left_out > kMaxIgnoredNotes)
    notes.push_back(fmt::format("and {} more such tags: skipped", left_out - kMaxIgnoredNotes));
  return out;
}

}  // namespace throng
