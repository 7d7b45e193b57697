// expect_same_walk() checks that a crowd is independent of threads and resumes from a checkpoint.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "base/files/archive.h"
#include "tests/crowd/crowd_world.h"

namespace throng {

/// Walks a scene for some steps before and after its state is saved.
inline void expect_same_walk(const Scene& scene, int steps_before, int steps_after) {
  const auto walk = [](SmallWorld& world, int steps) {
    for (int step = 0; step < steps; ++step) world.crowd.step();
    return std::vector<Eigen::Vector2d>(world.crowd.positions_m().begin(),
                                        world.crowd.positions_m().end());
  };
  std::vector<Eigen::Vector2d> expected;
  std::vector<uint8_t> state;
  for (const int threads : {1, 2, 5}) {
    SmallWorld world(scene, threads);
    walk(world, steps_before);
    if (threads == 2) {
      Archive out;
      world.crowd.archive(out);
      state = out.bytes();
    }
    const std::vector<Eigen::Vector2d> found = walk(world, steps_after);
    if (threads == 1) expected = found;
    EXPECT_EQ(found, expected) << threads << " threads, seed " << scene.seed;
  }
  SmallWorld resumed(scene, 1);
  Archive in(state, "test");
  resumed.crowd.archive(in);
  in.expect_end();
  EXPECT_EQ(walk(resumed, steps_after), expected) << "resumed, seed " << scene.seed;
}

}  // namespace throng
