// The checks a URDF has to pass before urdfdom sees what is read of it, each complaint with its
// line. One rule: whatever urdfdom or KDL would crash on, or accept and get wrong, is refused here;
// what no posed shape depends on refuses nothing.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/limits.h"
#include "kinematics/xml_scan.h"

namespace throng {

/// A real URDF is below 1 MB and 6 tags deep (a dozen with simulator extensions); tinyxml, which
/// urdfdom uses, overflows the stack at some 10^5 nested tags, and looks through all attributes of
/// a tag for each further one: a tag of URDF has ten at most.
inline constexpr XmlLimits kUrdfLimits{.bytes = 16u << 20,
                                       .depth = 64,
                                       .elements = 200'000,
                                       .value_bytes = 4096,
                                       .attributes = 64,
                                       .name_bytes = 256};
/// Three shapes a link are many; a sphere becomes some hundred triangles.
inline constexpr int kMaxShapes = 16'384;
/// Beyond 10 km a float no longer tells millimetres apart.
inline constexpr double kMaxLength_m = 1e4;
/// Beyond some hundred turns the sine of a float angle loses its fourth digit.
inline constexpr double kMaxAngle_rad = 1e3;
/// From micrometres to kilometres, in either direction.
inline constexpr double kMaxMeshScale = 1e6;

/// All numbers of a white-space separated list, or nothing if one of them is not a finite number.
std::optional<std::vector<double>> finite_numbers(std::string_view text);

/// What is read of a URDF that is sound.
struct UrdfCheckResult {
  std::vector<bool> skipped;             ///< by element: links, joints and shapes that are left out
  std::vector<std::string> notes;        ///< a line for each such element or group of them
  std::vector<std::string> assumptions;  ///< see parse_urdf()
};

/// Throws InputError "file:line: ..." at the first defect.
UrdfCheckResult check_urdf(const std::vector<XmlElement>& elements, const std::string& file);

/// Finds what is still to be expanded: xacro is a language of macros for URDFs, and its program
/// makes plain ones of them. Throws InputError "file:line: ..." at the first tag of xacro, and at
/// the first `${...}` or `$(...)` in what links and joints consist of: extensions may use those
/// otherwise.
void refuse_xacro(const std::vector<XmlElement>& elements, const std::string& file);

/// The tags that Throng makes no use of, or does not know: aggregated by tag, a line each.
std::vector<std::string> unused_in_urdf(const std::vector<XmlElement>& elements);

}  // namespace throng
