// A warm step of a whole simulation allocates nothing but what growing contacts need, and that is
// counted: every operator new of the process is.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "scenes/scenes.h"

namespace {
std::atomic<size_t> allocations{0};

void* counted(size_t size, size_t alignment) {
  ++allocations;
  void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
}  // namespace

void* operator new(size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new(size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { std::free(memory); }

namespace throng {
namespace {

TEST(Simulation, AWarmStepAllocatesOnlyWhatItCountsAsGrowth) {
  Scene scene = load_scene("corridor");
  for (const int threads : {1, 2}) {
    Simulation simulation(scene, {.threads = threads});
    for (int frame = 0; frame < 240; ++frame) simulation.step();
    size_t uncounted = 0, steps_that_grew = 0;
    for (int frame = 0; frame < 240; ++frame) {
      const size_t before = allocations;
      const Frame& now = simulation.step();
      const bool grew = now.counters->allocations_grown > 0;
      steps_that_grew += grew;
      if (!grew) uncounted += allocations - before;
    }
    EXPECT_EQ(uncounted, 0u) << threads << " threads: steps that report no growth allocated";
    EXPECT_LT(steps_that_grew, 60u) << threads << " threads";
  }
}

}  // namespace
}  // namespace throng
