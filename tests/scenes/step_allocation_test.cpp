// A warm step of a whole simulation allocates nothing but what growing contacts need, and that is
// counted: every operator new of the process is.
#include <gtest/gtest.h>

#include "scenes/scenes.h"
#include "tests/allocation_counter.h"

namespace throng {
namespace {

TEST(Simulation, AWarmStepAllocatesOnlyWhatItCountsAsGrowth) {
  Scene scene = load_scene("corridor");
  for (const int threads : {1, 2}) {
    Simulation simulation(scene, {.threads = threads});
    for (int frame = 0; frame < 240; ++frame) simulation.step();
    size_t uncounted = 0, steps_that_grew = 0;
    for (int frame = 0; frame < 240; ++frame) {
      const size_t before = testing::allocations_so_far();
      const Frame& now = simulation.step();
      const bool grew = now.counters->allocations_grown > 0;
      steps_that_grew += grew;
      if (!grew) uncounted += testing::allocations_so_far() - before;
    }
    EXPECT_EQ(uncounted, 0u) << threads << " threads: steps that report no growth allocated";
    EXPECT_LT(steps_that_grew, 60u) << threads << " threads";
  }
}

}  // namespace
}  // namespace throng
