// Footfalls: where the legs of somebody who walks are, and what decides where they will be.
// One rule: what is foreseen is what Stepping does if the root goes straight on.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "avatars/stepping/stepping.h"

namespace throng {

/// Somebody's steps, as the ground has them: metres, from any point that all share.
struct WalkState {
  Eigen::Vector2f root_m, velocity_mps;
  Eigen::Vector2f ahead;  ///< unit: the way the root faces
  float scale;
  float phase, cadence_hz;
  FootTrack track;
  const SwingCurve* swing;
  /// Of the feet from where the gait has them, root frame at scale 1: right x, y, left x, y.
  std::array<float, 4> shift_m;
  /// How far from where it would the next step of each foot lands, likewise.
  std::array<float, 4> landing_m;

  /// The same as somebody else has it: from its root, along its axes, in lengths of its scale.
  WalkState in_frame_of(const WalkState& other) const;
};

/// Whoever steps more rarely stands.
inline constexpr float kMinCadence_hz = 0.1f;

/// A leg, seen from above: points of it near the ground, in the middle of the shin and at the knee.
struct LegPlace {
  Eigen::Vector2f foot_m, shin_m, knee_m;
};

/// A leg now and how it goes on, in the root frame of now at scale 1: x ahead, y to the left.
struct LegState {
  LegState() = default;
  LegState(const WalkState& steps, size_t side);

  Eigen::Vector2f velocity_mps;  ///< of the root
  Eigen::Vector2f foot_m;        ///< where it stands, or would
  Eigen::Vector2f off_m;         ///< from where the gait has it
  Eigen::Vector2f landing_m;     ///< its next step lands so far from where it would
  SwingCurve swing;
  float phase, cadence_hz;  ///< of its own cycle: from one landing to the next
  float stance;
  float lands_x_m, lifts_x_m, passes_x_m, side_m;
  float kept;  ///< what is left of off_m now, of what it was when the foot lifted
  bool is_right;
  Eigen::Vector2f root_m, ahead_m;  ///< from this frame to that of WalkState

  /// When a foot that is about to land does so; negative: not in the next step.
  float lands_s() const;
};

}  // namespace throng
