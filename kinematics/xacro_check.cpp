#include "kinematics/xacro_check.h"

#include <fmt/format.h>

#include <string_view>

#include "base/errors.h"
#include "base/text.h"

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

}  // namespace throng
