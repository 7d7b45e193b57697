// SeparationRule holds a scene's parameters of speed and separation monitoring (ISO/TS 15066). They
// are parameters of a study; no table of a standard is included.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace throng {

struct Scene;

struct SeparationRule {
  std::optional<double> human_speed_mps;  ///< towards the robot; empty: measured
  std::optional<double> robot_speed_mps;  ///< towards the person; empty: measured
  double reaction_s = 0;                  ///< time until the robot begins to stop
  /// Stopping time or deceleration of the robot after that; exactly one is set.
  std::optional<double> stopping_s, deceleration_mps2;
  double intrusion_m = 0;          ///< C: intrusion of a person before detection
  double human_uncertainty_m = 0;  ///< Z_d: position uncertainty of the person
  double robot_uncertainty_m = 0;  ///< Z_r: position uncertainty of the robot
  std::string where{};

  /// Whether a speed is measured, which requires triangle tests.
  bool is_measured() const { return !human_speed_mps || !robot_speed_mps; }
};

/// Protective separation distance S = S_h + S_r + S_s + C + Z_d + Z_r after J. Marvel, R. Norcross:
/// Implementing speed and separation monitoring in collaborative robot workcells, Robotics and
/// Computer-Integrated Manufacturing 44 (2017), PMC5117641.
struct ProtectiveDistance {
  double human_m = 0;     ///< S_h = v_h (T_r + T_s), path of the person until the robot stands
  double reaction_m = 0;  ///< S_r = v_r T_r, path of the robot before it stops
  double stopping_m = 0;  ///< S_s = v_r T_s / 2, path of the robot at constant deceleration
  double fixed_m = 0;     ///< C + Z_d + Z_r

  double total_m() const { return human_m + reaction_m + stopping_m + fixed_m; }
};

/// Computes the distance from speeds towards each other; negative speeds count as 0, NaN gives NaN.
/// T_s is the rule's stopping time, or v_r over its deceleration.
ProtectiveDistance protective_distance(const SeparationRule& rule, double human_speed_mps,
                                       double robot_speed_mps);

/// Throws InputError if the scene's separation needs a margin, triangle tests or a larger margin.
void require_valid_separation(const Scene& scene);

/// Throws InputError if the scene has no separation; `where` names the option that needs it.
void require_separation(const Scene& scene, const std::string& where);

/// Notes for the user: speeds that the margin covers, and parts of people without a region.
std::vector<std::string> separation_notes(const Scene& scene);

}  // namespace throng
