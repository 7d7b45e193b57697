// PreferredVelocity finds the velocity that an agent prefers: along the way of its journey at its
// desired speed, taken up smoothly, and up to a closed door.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "crowd/doorkeeper.h"
#include "crowd/journeys.h"
#include "crowd/parties.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// Time to take up a wanted velocity (Helbing and Molnar 1995: 0.5 s).
inline constexpr double kRelaxation_s = 0.5;
/// Breaks the symmetry of people who meet exactly head on.
inline constexpr double kPerturbation_mps = 1e-3;
/// How far to a side somebody stuck tries to go past, at most, as a multiple of the way ahead.
inline constexpr double kSidestep = 2.0;
/// People who wait before a closed door stand so far apart beyond their discs, behind whoever is
/// ahead within 60 degrees (the cosine).
inline constexpr double kWaits_m = 0.05;
inline constexpr double kBehind = 0.5;

}  // namespace tuning

class PreferredVelocity {
 public:
  /// Keeps references to all.
  PreferredVelocity(SteeringState& state, const Journeys& journeys, const Parties& parties,
                    const Doorkeeper& doorkeeper, uint64_t seed)
      : state_(state),
        journeys_(journeys),
        parties_(parties),
        doorkeeper_(doorkeeper),
        seed_(seed) {}

  /// Finds the lateral offsets of agents, and asks for the fields that their ways come from.
  void prepare(SteeringState::Slots slots);

  /// Decides what an agent prefers, whom it has as neighbours; it faces its way then.
  void decide(size_t slot);

  /// Shows which agents stand before a closed door, after all have decided what they prefer.
  void show_held(SteeringState::Slots slots);

 private:
  Eigen::Vector2d wanted_mps(size_t slot);
  double own_side_m(size_t slot) const;
  OwnSide own_side(size_t slot) const {
    return {state_.agents[slot].own_side_m, state_.agents[slot].facing};
  }
  double pace_before_door(size_t slot, const Eigen::Vector2d& way);

  SteeringState& state_;
  const Journeys& journeys_;
  const Parties& parties_;
  const Doorkeeper& doorkeeper_;
  uint64_t seed_;
};

}  // namespace throng
