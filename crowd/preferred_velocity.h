// PreferredVelocity finds the velocity that an agent prefers: along the way of its journey at its
// desired speed, taken up smoothly, and up to a closed door.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "crowd/door_controller.h"
#include "crowd/journeys.h"
#include "crowd/social_groups.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// Time to take up a wanted velocity (Helbing and Molnar 1995: 0.5 s).
inline constexpr double kRelaxation_s = 0.5;
/// Breaks the symmetry of people who meet exactly head on.
inline constexpr double kPerturbation_mps = 1e-3;
/// How far to a side somebody stuck tries to go past, at most, as a multiple of the way ahead.
inline constexpr double kMaxSidestep = 2.0;
/// People who wait before a closed door stand so far apart beyond their discs, behind whoever is
/// ahead within 60 degrees (the cosine).
inline constexpr double kDoorGap_m = 0.05;
inline constexpr double kBehindCosine = 0.5;

}  // namespace tuning

class PreferredVelocity {
 public:
  /// Keeps references to all.
  PreferredVelocity(SteeringState& state, const Journeys& journeys, const SocialGroups& groups,
                    const DoorController& doorkeeper, uint64_t seed)
      : state_(state),
        journeys_(journeys),
        social_groups_(groups),
        door_controller_(doorkeeper),
        seed_(seed) {}

  /// Finds the lateral offsets of agents, and asks for the fields that their ways come from.
  void prepare(SteeringState::Slots slots);

  /// Decides what an agent prefers, whom it has as neighbours; it faces its way then.
  void decide(size_t slot);

  /// Shows which agents stand before a closed door, after all have decided what they prefer.
  void publish_waiting(SteeringState::Slots slots);

 private:
  Eigen::Vector2d preferred_mps(size_t slot);
  double lateral_offset_m(size_t slot) const;
  LateralOffset lateral_offset(size_t slot) const {
    return {state_.agents[slot].lateral_offset_m, state_.agents[slot].facing};
  }
  double door_speed_factor(size_t slot, const Eigen::Vector2d& direction);

  SteeringState& state_;
  const Journeys& journeys_;
  const SocialGroups& social_groups_;
  const DoorController& door_controller_;
  uint64_t seed_;
};

}  // namespace throng
