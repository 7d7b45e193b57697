// How far a robot has to be from a person for it to stand before they meet.
// One rule: the sum of the open description of speed and separation monitoring, with constant
// speeds; a study's measure, not a safety function.
#pragma once

#include "scenes/separation/separation_rule.h"

namespace throng {

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
ProtectiveDistance protective_distance(const SeparationRule& rule, double human_mps,
                                       double robot_mps);

}  // namespace throng
