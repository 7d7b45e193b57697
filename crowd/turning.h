// Turning turns bodies and heads to the walking direction, or to what standing agents wait for.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "crowd/journeys.h"
#include "crowd/queues.h"
#include "crowd/social_groups.h"
#include "crowd/spawn.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// Maximum turn rate and angular acceleration of bodies. A hip turns by 2.6 times as much, because
/// a foot is in the air for little more than a third of a cycle.
inline constexpr double kMaxTurn_radps = 2.0;
inline constexpr double kTurnWalking_radps2 = 40.0;
/// Averaging time of the velocity that the body follows; prevents shaking in crowds.
inline constexpr double kTurnSmoothing_s = 0.5;
/// Below the first speed agents face their target, above the second their walking direction.
inline constexpr double kStandingSpeed_mps = 0.3;
inline constexpr double kWalkingSpeed_mps = 0.5;
/// A standing agent turns its body from this angle on; below it only the head turns.
inline constexpr double kTurnFrom_rad = 0.45;
/// A turn on the spot ends at this angle, with this acceleration and maximum rate. People take two
/// to three seconds for quarter to half turns.
inline constexpr double kTurnTo_rad = 0.035;
inline constexpr double kTurnStart_radps2 = 3.0;
inline constexpr double kTurnOnSpot_radps = 0.85;
/// Deceleration of a turn when the walk ends.
inline constexpr double kTurnStop_radps2 = 10.0;
/// Time for the head to reach the preferred direction, ahead of the body.
inline constexpr float kHeadYawTime_s = 0.25f;
/// Angular acceleration of the head; its target changes at once.
inline constexpr float kHeadYaw_radps2 = 40;

}  // namespace tuning

class Turning {
 public:
  /// Keeps references to all but `people`.
  Turning(SteeringState& state, const Journeys& journeys, const SocialGroups& groups,
          const Queues& queues, std::span<const AgentSpec> people);

  /// Sets what a standing agent faces and the target of its head yaw. Requires the preferred
  /// velocity, in whose direction the agent faces so far.
  void decide(size_t slot);

  /// Turns body and head for one step at its velocity. Returns the heading change (rad).
  double step(size_t slot);

 private:
  void find_facing(size_t slot);
  float target_head_yaw_rad(size_t slot) const;
  double turn(size_t slot);
  double turn_to_direction(size_t slot, const Eigen::Vector2d& to);
  double turn_on_spot(size_t slot, double walks, const Eigen::Vector2d& to);
  double apply_turn(size_t slot, double target_radps, double max_radps2);
  void turn_head(size_t slot);

  SteeringState& state_;
  const Journeys& journeys_;
  const SocialGroups& social_groups_;
  const Queues& queues_;
  /// by id: look-at points of standing agents
  std::vector<std::optional<Eigen::Vector2d>> look_at_m_;
};

}  // namespace throng
