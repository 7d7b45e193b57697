// How far a robot has to be from people: what a scene says of it.
// One rule: parameters of a study; no table of any standard stands here.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace throng {

struct Scene;

/// Parameters of speed and separation monitoring, see protective_distance().
struct SeparationRule {
  std::optional<double> human_speed_mps;  ///< towards the robot; none: as measured
  std::optional<double> robot_speed_mps;  ///< towards the person; none: as measured
  double reaction_s = 0;                  ///< until the robot begins to stop
  /// From then until it stands: so long, or by so much; the scene says one of the two.
  std::optional<double> stopping_s, deceleration_mps2;
  double intrusion_m = 0;          ///< C: what is reached in before it is seen
  double human_uncertainty_m = 0;  ///< Z_d: of where the person is
  double robot_uncertainty_m = 0;  ///< Z_r: of where the robot is
  std::string where{};             ///< in the file, for complaints

  /// Speeds are known where the triangles were asked.
  bool is_measured() const { return !human_speed_mps || !robot_speed_mps; }
};

/// S = S_h + S_r + S_s + C + Z_d + Z_r: what the person covers until the robot stands, what the
/// robot covers until it begins to stop and while it stops, how far somebody reaches in unseen, and
/// how wrong both places may be. J. Marvel, R. Norcross: Implementing speed and separation
/// monitoring in collaborative robot workcells, Robotics and Computer-Integrated Manufacturing 44
/// (2017), PMC5117641.
struct ProtectiveDistance {
  double human_m = 0;     ///< S_h = v_h (T_r + T_s)
  double reaction_m = 0;  ///< S_r = v_r T_r
  double stopping_m = 0;  ///< S_s = v_r T_s / 2: the robot brakes evenly
  double fixed_m = 0;     ///< C + Z_d + Z_r

  double total_m() const { return human_m + reaction_m + stopping_m + fixed_m; }
};

/// Speeds are towards each other; whoever goes away counts as standing. NaN where a speed is. T_s
/// is the rule's, or v_r through its deceleration.
ProtectiveDistance protective_distance(const SeparationRule& rule, double human_speed_mps,
                                       double robot_speed_mps);

/// Throws InputError where the scene has a separation that needs a margin, triangles, or a larger
/// margin than the scene has.
void require_valid_separation(const Scene& scene);

/// Throws InputError where there is nothing to be written; `where` names the option that asks.
void require_separation(const Scene& scene, const std::string& where);

/// What is to be known of it: up to which speeds the margin reaches, parts of people that are of no
/// region of the body.
std::vector<std::string> separation_notes(const Scene& scene);

}  // namespace throng
