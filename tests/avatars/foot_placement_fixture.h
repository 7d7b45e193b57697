// Walkers for tests of foot placement and leg prediction.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "avatars/body_avoidance/leg_state.h"
#include "base/random.h"
#include "tests/avatars/gait_fixture.h"

namespace throng::test {

/// Returns an adult who walks ahead as in the gait.
inline WalkState walks(const Eigen::Vector2f& at_m, float phase, float speed_mps = 1.3f) {
  const Gait& gait = Walking::adult().gait;
  WalkState steps{};
  steps.root_m = at_m;
  steps.velocity_mps = {speed_mps, 0};
  steps.ahead = {1, 0};
  steps.scale = 1;
  steps.phase = phase;
  steps.track = gait.track_at(speed_mps, 1);
  steps.cadence_hz = speed_mps / steps.track.stride_m;
  steps.swing = &gait.swing();
  return steps;
}

inline float drawn(uint64_t seed, uint32_t index, double low, double high) {
  return static_cast<float>(
      random_uniform({seed, 0, 0, Purpose::kSpawnPosition}, low, high, index));
}

}  // namespace throng::test
