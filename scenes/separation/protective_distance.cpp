#include "scenes/separation/protective_distance.h"

namespace throng {
namespace {

/// NaN stays NaN.
double at_least_zero(double speed_mps) { return speed_mps < 0 ? 0 : speed_mps; }

}  // namespace

ProtectiveDistance protective_distance(const SeparationRule& rule, double human_mps,
                                       double robot_mps) {
  const double human = at_least_zero(human_mps), robot = at_least_zero(robot_mps);
  const double stopping_s =
      rule.stopping_s ? *rule.stopping_s : robot / rule.deceleration_mps2.value_or(1);
  return {human * (rule.reaction_s + stopping_s), robot * rule.reaction_s, 0.5 * robot * stopping_s,
          rule.intrusion_m + rule.human_error_m + rule.robot_error_m};
}

}  // namespace throng
