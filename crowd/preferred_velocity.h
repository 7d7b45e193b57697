// PreferredVelocity computes the preferred velocity of an agent: along its journey's path at its
// desired speed, smoothed, and limited before a closed door.
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

/// Relaxation time of the preferred velocity (Helbing and Molnar 1995: 0.5 s).
inline constexpr double kRelaxation_s = 0.5;
/// Breaks the symmetry of agents that meet exactly head-on.
inline constexpr double kPerturbation_mps = 1e-3;
/// Maximum sidestep of a stuck agent, as a multiple of the path ahead.
inline constexpr double kMaxSidestep = 2.0;
/// Gap between discs that wait before a closed door, to those ahead within 60 degrees (cosine).
inline constexpr double kDoorGap_m = 0.05;
inline constexpr double kBehindCosine = 0.5;

}  // namespace tuning

class PreferredVelocity {
 public:
  /// Keeps references to all.
  PreferredVelocity(SteeringState& state, const Journeys& journeys, const SocialGroups& groups,
                    const DoorController& door_controller, uint64_t seed)
      : state_(state),
        journeys_(journeys),
        social_groups_(groups),
        door_controller_(door_controller),
        seed_(seed) {}

  /// Updates lateral offsets and prefetches the fields that directions come from.
  void prepare(SteeringState::Slots slots);

  /// Sets an agent's preferred velocity. Requires its neighbours; sets its facing to its direction.
  void decide(size_t slot);

  /// Publishes which agents wait before a closed door, after all decide() calls.
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
