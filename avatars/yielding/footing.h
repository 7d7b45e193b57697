// Footing: how the steps of somebody who walks keep clear of others' legs: in rhythm with those who
// are close ahead, and landing beside their feet.
// One rule: of two feet the one that lands later gives way.
#pragma once

#include <Eigen/Core>
#include <span>

#include "avatars/yielding/footfall.h"
#include "base/simd.h"

namespace throng {

/// How much longer strides than the gait's (and rarer, then) keep legs apart from those of others;
/// 1 if it makes no difference. `now` is what they are.
float stretch_for(const Steps& own, std::span<const Steps> near, float now, SimdTarget target);

/// How far from where it would a foot has to land (root frame, scale 1).
Eigen::Vector2f landing_shift_m(const Steps& own, size_t side, std::span<const Steps> near,
                                SimdTarget target);

}  // namespace throng
