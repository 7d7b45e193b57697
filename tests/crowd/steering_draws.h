// Steering draws are random numbers and velocities for tests of steering.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/portable_math.h"
#include "base/random.h"

namespace throng {

inline float uniform(uint64_t seed, uint64_t id, double low, double high) {
  return static_cast<float>(random_uniform({seed, id, 0, Purpose::kBoxWorld}, low, high));
}

inline Eigen::Vector2f polar(float length, float angle_rad) {
  const SinCos turn = sin_cos(static_cast<double>(angle_rad));
  return {length * static_cast<float>(turn.cos), length * static_cast<float>(turn.sin)};
}

}  // namespace throng
