// OverlapRelaxation pushes overlapping discs apart after those who decide have chosen their
// velocities, sweep by sweep, until none overlaps deeper than kSlop_m. Others go on as they have
// decided.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "crowd/crowd_counters.h"
#include "crowd/navigation/walkable.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// Sweeps of disc relaxation a decision, at most, and the share of an overlap that each of two
/// people gives way in one.
inline constexpr int kSweeps = 40;
inline constexpr double kSweepShare = 0.5;
/// Overlaps below this are left alone.
inline constexpr double kSlop_m = 0.005;
/// Sweeps look at those who are this near to touching: no push goes farther.
inline constexpr double kSweepMargin_m = 0.12;
/// The fastest that relaxation moves anybody: a push, not a jump.
inline constexpr double kMaxDrift_mps = 1.0;
/// By so much of its radius a disc grows a decision where people stand closer than discs: they are
/// apart again some three seconds after they have set out, pushed by a few centimetres a second.
inline constexpr double kRadiusGrowth = 0.01;

}  // namespace tuning

class OverlapRelaxation {
 public:
  /// Keeps references to both.
  OverlapRelaxation(SteeringState& state, const Walkable& walkable)
      : state_(state), decisions_(state.decisions), walkable_(walkable) {}

  /// Lets the disc of an agent that was placed closer to others than discs are take more room.
  void grow(size_t slot, bool walks);

  /// Pushes apart the discs of those who decide now, which becomes the drift of their next period,
  /// and counts sweeps and the deepest overlap. Brings close neighbours to the front.
  void relax(SteeringCounters& counters);

 private:
  double find_overlap_candidates(SteeringState::Slots slots, size_t block);
  double sweep(size_t block);
  bool is_settled(size_t slot) const;
  double relax_disc(size_t slot);
  void limit_forward_push(size_t slot, float& to_x, float& to_y) const;
  void set_drift(SteeringState::Slots slots);
  Eigen::Vector2f expected_m(size_t slot) const;
  /// Discs whose centres are nearer are pushed apart.
  float apart_m(size_t slot, size_t other) const {
    return state_.traits.core_radius_scale *
           (state_.agents.published[slot].radius_m + state_.agents.published[other].radius_m);
  }

  SteeringState& state_;
  Decisions& decisions_;
  const Walkable& walkable_;
};

}  // namespace throng
