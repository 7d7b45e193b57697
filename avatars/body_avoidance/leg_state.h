// WalkState and LegState describe the steps of a walker and what decides where its legs will be.
// Invariant: a prediction from them equals what Stepping does if the root goes straight on.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "avatars/stepping/stepping.h"

namespace throng {

/// Steps of one walker in the world frame, relative to a point common to all.
struct WalkState {
  Eigen::Vector2f root_m, velocity_mps;
  Eigen::Vector2f ahead;  ///< unit vector along the root's heading
  float scale;
  float phase, cadence_hz;
  FootTrack track;
  const SwingCurve* swing;
  /// Offset of the feet from their place in the gait, root frame at scale 1: right x, y, left x, y.
  std::array<float, 4> shift_m;
  /// Shift of the next landing of each foot, in the same order and frame.
  std::array<float, 4> landing_m;

  /// Returns this state in the root frame of `other`, in units of its scale.
  WalkState in_frame_of(const WalkState& other) const;
};

inline constexpr float kMinCadence_hz = 0.1f;

/// A leg seen from above: foot near the ground, middle of the shin, and knee.
struct LegPlace {
  Eigen::Vector2f foot_m, shin_m, knee_m;
};

/// Current state of a leg, in the current root frame at scale 1: x ahead, y to the left.
struct LegState {
  LegState() = default;
  LegState(const WalkState& steps, size_t side);

  Eigen::Vector2f velocity_mps;  ///< velocity of the root
  Eigen::Vector2f foot_m;        ///< where the foot stands, or would stand
  Eigen::Vector2f off_m;         ///< offset from its place in the gait
  Eigen::Vector2f landing_m;     ///< shift of the next landing
  SwingCurve swing;
  float phase, cadence_hz;  ///< of the leg's own cycle, from one landing to the next
  float stance;
  float lands_x_m, lifts_x_m, passes_x_m, side_m;
  float offset_share;  ///< share of off_m at lift-off that remains now
  bool is_right;
  Eigen::Vector2f root_m, ahead_m;  ///< from this frame to that of WalkState

  /// Seconds until a foot that is about to land does so; negative: not in the next step.
  float lands_s() const;
};

}  // namespace throng
