// Walking updates gait speed, phase, feet and legs of bodies from the motion of their roots.
// Invariant: the result depends on each root's path only, never on whether its posture is computed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/simd.h"
#include "scenes/run/posing.h"

namespace throng {

/// Rotation about z for a heading given as unit vector. Uses half-angle formulas: exact to rounding
/// and equal on every machine.
inline Eigen::Quaternionf rotation_to(const Eigen::Vector2d& heading) {
  const double cosine = std::clamp(heading.x(), -1.0, 1.0);
  // The larger component by the root, the smaller from the larger, which has lost no digits.
  const double larger = std::sqrt(0.5 * (1 + std::abs(cosine)));
  const double smaller = 0.5 * std::abs(heading.y()) / larger;
  const double w = cosine > 0 ? larger : smaller;
  const double z = std::copysign(cosine > 0 ? smaller : larger, heading.y());
  return Eigen::Quaternionf(static_cast<float>(w), 0, 0, static_cast<float>(z));
}

/// Rotation about z by less than half a turn in either direction.
Eigen::Quaternionf rotation_by(float angle_rad);

struct WalkInput {
  RootPose before;
  float ahead_mps = 0;
  bool is_present = true;  ///< false: phase, feet and legs stay unchanged
  float stride_scale = 1;  ///< stride length over that of the gait
  /// While standing; false for recorded heads, whose shifts are measured.
  bool shifts_weight = true;
};

/// Advances gait speeds, phases, feet and legs of consecutive avatars of one model to bodies.roots.
/// `avatars` begins with id `first` and has at most WalkBatch::kCapacity elements.
void advance_walk(const Posing& posing, std::span<const WalkInput> avatars, double step_s,
                  uint32_t first, SimdTarget target, BodyStates& bodies);

/// Advances gait speed and phase of an avatar by its gait alone, regardless of its path.
void advance_phase(const Posing& posing, float speed_mps, double walked_m, uint32_t id,
                   BodyStates& bodies);

}  // namespace throng
