// check_urdf() validates a URDF before urdfdom reads it, and reports defects with their line.
// Invariant: URDFs that would crash urdfdom or KDL, or be misread by them, are rejected here.
// Content that no posed shape depends on causes no rejection.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/limits.h"
#include "kinematics/xml_scan.h"

namespace throng {

/// Real URDFs are below 1 MB and 6 tags deep (a dozen with simulator extensions). tinyxml, used by
/// urdfdom, overflows the stack at about 10^5 nested tags. Its time is quadratic in the attributes
/// of a tag; URDF tags have ten at most.
inline constexpr XmlLimits kUrdfLimits{.bytes = 16u << 20,
                                       .depth = 64,
                                       .elements = 200'000,
                                       .value_bytes = 4096,
                                       .attributes = 64,
                                       .name_bytes = 256};
/// More than three shapes per link are unusual; a sphere becomes some hundred triangles.
inline constexpr int kMaxShapes = 16'384;
/// Beyond 10 km a float does not resolve millimetres.
inline constexpr double kMaxLength_m = 1e4;
/// Beyond some hundred turns the sine of a float angle loses its fourth digit.
inline constexpr double kMaxAngle_rad = 1e3;
/// From micrometres to kilometres, in either direction.
inline constexpr double kMaxMeshScale = 1e6;

/// Returns all numbers of a white-space separated list, or nothing if one is not finite.
std::optional<std::vector<double>> finite_numbers(std::string_view text);

struct UrdfCheckResult {
  std::vector<bool> skipped;             ///< indexed by element: links, joints and shapes to skip
  std::vector<std::string> notes;        ///< a line for each such element or group of them
  std::vector<std::string> assumptions;  ///< see parse_urdf()
};

/// Throws InputError "file:line: ..." at the first defect.
UrdfCheckResult check_urdf(const std::vector<XmlElement>& elements, const std::string& file);

/// Rejects URDFs that must be expanded by xacro, a macro language. Throws InputError "file:line:
/// ..." at the first xacro tag, and at the first `${...}` or `$(...)` in links and joints.
/// Extensions may use these for other purposes.
void reject_xacro(const std::vector<XmlElement>& elements, const std::string& file);

/// Returns the tags that Throng does not use or know: aggregated by tag, one line each.
std::vector<std::string> unused_in_urdf(const std::vector<XmlElement>& elements);

}  // namespace throng
