// Turning turns bodies and heads: agents face where they walk, and what they wait for while they
// stand.
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

/// The fastest the body turns, and how hard it begins to: a hip turns by 2.6 times that, as a foot
/// is in the air for little more than a third of a cycle.
inline constexpr double kMaxTurn_radps = 2.0;
inline constexpr double kTurnWalking_radps2 = 40.0;
/// The body follows the mean velocity of about this time, so that it does not shake in a throng.
inline constexpr double kTurnSmoothing_s = 0.5;
/// Slower than the first a person stands and faces what it waits for, faster than the second it
/// faces the way it walks.
inline constexpr double kStandingSpeed_mps = 0.3;
inline constexpr double kWalkingSpeed_mps = 0.5;
/// Whoever stands turns when what it waits for is so far off; as far as that the head alone turns.
inline constexpr double kTurnFrom_rad = 0.45;
/// Such a turn goes on to here, begins and ends as gently as this, and is never faster: people who
/// are asked to turn on the spot take two to three seconds for a quarter turn to half a turn.
inline constexpr double kTurnTo_rad = 0.035;
inline constexpr double kTurnStart_radps2 = 3.0;
inline constexpr double kTurnOnSpot_radps = 0.85;
/// A turn of somebody who walks slows down to that when the walk ends.
inline constexpr double kTurnStop_radps2 = 10.0;
/// The head turns to where its owner wants to go in about this time, before the body does.
inline constexpr float kHeadYawTime_s = 0.25f;
/// It speeds up and slows down no faster; where it looks changes at once.
inline constexpr float kHeadYaw_radps2 = 40;

}  // namespace tuning

class Turning {
 public:
  /// Keeps references to all but `people`.
  Turning(SteeringState& state, const Journeys& journeys, const SocialGroups& groups,
          const Queues& queues, std::span<const AgentSpec> people);

  /// Decides what an agent faces when it stands, and where its head turns. The agent has its
  /// preferred velocity, and faces its way so far.
  void decide(size_t slot);

  /// Turns body and head on by a step, once the agent has the velocity of the step. Returns by how
  /// much the heading turned (rad).
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
  std::vector<std::optional<Eigen::Vector2d>> look_at_m_;  ///< by person: seen while they stand
};

}  // namespace throng
