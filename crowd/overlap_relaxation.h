// OverlapRelaxation pushes overlapping discs apart after agents have chosen their velocities, sweep
// by sweep, until no overlap exceeds kSlop_m. Agents that do not decide now are not moved.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "crowd/crowd_counters.h"
#include "crowd/navigation/walkable.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// Maximum number of sweeps per decision, and each agent's share of an overlap per sweep.
inline constexpr int kSweeps = 40;
inline constexpr double kSweepShare = 0.5;
/// Smaller overlaps are ignored.
inline constexpr double kSlop_m = 0.005;
/// Sweeps consider discs that are this close to touching: no push goes farther.
inline constexpr double kSweepMargin_m = 0.12;
/// Upper bound of the drift velocity: a push, not a jump.
inline constexpr double kMaxDrift_mps = 1.0;
/// Growth per decision of discs placed closer than their radii, as a share of the radius. About
/// three seconds after setting out they are apart, pushed by a few centimetres per second.
inline constexpr double kRadiusGrowth = 0.01;

}  // namespace tuning

class OverlapRelaxation {
 public:
  /// Keeps references to both.
  OverlapRelaxation(SteeringState& state, const Walkable& walkable)
      : state_(state), decisions_(state.decisions), walkable_(walkable) {}

  /// Grows the disc of an agent that was placed closer to others than its radius.
  void grow(size_t slot, bool walks);

  /// Pushes apart the discs of agents that decide now; the result is their drift in the next
  /// period. Counts sweeps and the deepest overlap. Moves close neighbours to the front.
  void relax(SteeringCounters& counters);

 private:
  double find_overlap_candidates(SteeringState::Slots slots, size_t block);
  double sweep(size_t block);
  bool is_settled(size_t slot) const;
  double relax_disc(size_t slot);
  void limit_forward_push(size_t slot, float& to_x, float& to_y) const;
  void set_drift(SteeringState::Slots slots);
  Eigen::Vector2f expected_m(size_t slot) const;
  /// Discs whose centres are closer are pushed apart.
  float apart_m(size_t slot, size_t other) const {
    return state_.traits.core_radius_scale *
           (state_.agents.published[slot].radius_m + state_.agents.published[other].radius_m);
  }

  SteeringState& state_;
  Decisions& decisions_;
  const Walkable& walkable_;
};

}  // namespace throng
