// How bodies walk where their roots go: speed, phase, feet and legs of the gait, step by step.
// One rule: it depends on the way of each root alone, never on whether anybody poses it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/simd.h"
#include "scenes/run/posing.h"

namespace throng {

/// Rotation about z of a heading given as unit vector, by half-angle formulas: exact to rounding
/// and the same on every machine.
inline Eigen::Quaternionf rotation_to(const Eigen::Vector2d& heading) {
  const double cosine = std::clamp(heading.x(), -1.0, 1.0);
  // The larger of the two from the root, the smaller from the larger, which has lost no digits.
  const double larger = std::sqrt(0.5 * (1 + std::abs(cosine)));
  const double smaller = 0.5 * std::abs(heading.y()) / larger;
  const double w = cosine > 0 ? larger : smaller;
  const double z = std::copysign(cosine > 0 ? smaller : larger, heading.y());
  return Eigen::Quaternionf(static_cast<float>(w), 0, 0, static_cast<float>(z));
}

/// About z by an angle of less than half a turn to either side.
Eigen::Quaternionf rotation_by(float angle_rad);

/// What advance_walk() asks of an avatar besides its root.
struct WalkInput {
  RootPose before;            ///< its root in the frame before
  float ahead_mps = 0;        ///< its speed, the way it faces
  bool is_present = true;     ///< if not, it keeps phase, feet and legs
  float stride_scale = 1;     ///< so much longer than the gait's own strides its strides are
  bool shifts_weight = true;  ///< where it stands; of a recorded head the shifts are known already
};

/// Walks avatars first, first + 1, ... of one model, at most WalkBatch::kCapacity, on to
/// bodies.roots: sets their gait speeds, phases, feet and legs.
void advance_walk(const Posing& posing, std::span<const WalkInput> avatars, double step_s,
                  uint32_t first, SimdTarget target, BodyStates& bodies);

/// Moves one on by the gait alone, whatever its way: sets gait speed and phase.
void advance_phase(const Posing& posing, float speed_mps, double walked_m, uint32_t id,
                   BodyStates& bodies);

}  // namespace throng
