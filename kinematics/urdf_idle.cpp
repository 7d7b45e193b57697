#include "kinematics/urdf_idle.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "kinematics/urdf_check.h"

namespace throng {
namespace {

/// A page; the rest is a number.
constexpr size_t kMostNotes = 40;

/// Finds the idle tags of links.
class Idle {
 public:
  explicit Idle(const std::vector<XmlElement>& elements) : elements_(elements) {}

  /// Why a child of a link is idle, or "".
  std::string reason_for(int child) const {
    const std::string_view name = at(child).name;
    if (name == "visual" || name == "collision") return without_surface(child);
    if (name == "inertial" && is_incomplete(child)) return "incomplete, and not used";
    return "";
  }

 private:
  const XmlElement& at(int element) const { return elements_[static_cast<size_t>(element)]; }

  /// How many of the sizes in an attribute are above 0; nothing if they are not what they should
  /// be.
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
    bool is_idle = false;
    if (kind == "box") {
      const auto edges = sizes_above_zero(shape, "size", 3);
      is_idle = edges && *edges < 2;  // a plate has a surface, a line has none
    } else if (kind == "sphere") {
      is_idle = sizes_above_zero(shape, "radius", 1) == size_t{0};
    } else if (kind == "cylinder" || kind == "capsule") {
      is_idle = sizes_above_zero(shape, "radius", 1) == size_t{0} &&
                sizes_above_zero(shape, "length", 1).has_value();
    }
    return is_idle ? fmt::format("a {} of size zero, which touches nothing", kind) : "";
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

std::string without_idle(const std::string& text, const std::vector<XmlElement>& elements,
                         std::vector<std::string>& notes) {
  std::string out = text;
  const Idle idle(elements);
  size_t left_out = 0;
  for (size_t i = 1; i < elements.size(); ++i) {
    const XmlElement& element = elements[i];
    if (element.parent < 0) continue;
    const XmlElement& owner = elements[static_cast<size_t>(element.parent)];
    if (owner.parent != 0 || owner.name != "link") continue;
    const std::string reason = idle.reason_for(static_cast<int>(i));
    if (reason.empty()) continue;
    const auto begin = static_cast<size_t>(element.name.data() - text.data()) - 1;
    for (size_t k = begin; k < element.end; ++k)
      if (out[k] != '\n') out[k] = ' ';
    if (++left_out > kMostNotes) continue;
    const std::string* name = owner.attribute("name");
    notes.push_back(fmt::format("<{}> of link '{}', line {}: skipped: {}", element.name,
                                name == nullptr ? "" : name->substr(0, kMaxNameBytes), element.line,
                                reason));
  }
  if (left_out > kMostNotes)
    notes.push_back(fmt::format("and {} more such tags: skipped", left_out - kMostNotes));
  return out;
}

}  // namespace throng
