// What the tags of a URDF say as a whole: those of xacro are refused, those without a use listed.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "kinematics/urdf_check.h"

namespace throng {
namespace {

[[noreturn]] void refuse(const XmlElement& element, const std::string& file,
                         const std::string& found) {
  throw InputError(at_line(file, element.line), "plain URDF",
                   found + "; expand it first: xacro FILE > robot.urdf");
}

/// What the names of xacro's own tags begin with.
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

void refuse_xacro(const std::vector<XmlElement>& elements, const std::string& file) {
  const std::vector<std::string> prefixes = prefixes_of(elements[0]);
  std::vector<bool> is_used(elements.size(), false);
  is_used[0] = true;
  for (size_t i = 0; i < elements.size(); ++i) {
    const std::string_view name = elements[i].name;
    for (const std::string& prefix : prefixes)
      if (name.starts_with(prefix))
        refuse(elements[i], file, fmt::format("<{}>", escaped(name.substr(0, 60))));
    if (i > 0)
      is_used[i] = elements[i].parent == 0 ? name == "link" || name == "joint"
                                           : is_used[static_cast<size_t>(elements[i].parent)];
    if (!is_used[i]) continue;
    for (const auto& [attribute, value] : elements[i].attributes)
      if (is_substitution(value, "${", '}') || is_substitution(value, "$(", ')'))
        refuse(elements[i], file,
               fmt::format("{}={}", escaped(attribute.substr(0, 60)), in_quotes(value)));
  }
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
