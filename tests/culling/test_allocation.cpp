// A pass allocates nothing once it has seen its frames: every operator new of the process is
// counted.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "culling/culling.h"
#include "tests/culling/random_world.h"

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

TEST(Culler, AllocatesNothingWhenItReplaysFramesItHasSeen) {
  std::vector<testing::RandomWorld> frames;
  for (uint64_t seed = 1; seed <= 5; ++seed)
    frames.emplace_back(seed, 400, 6, Eigen::Vector3d::Zero());
  for (const PairSearch search : {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute}) {
    for (const int threads : {1, 3}) {
      const bool exact = search == PairSearch::kGrid;
      Workers workers(threads);
      // The frames differ in poses only, so one set of types serves them all.
      Culler culler(frames[0].types, {.exact = exact, .pair_search = search}, workers);
      for (int warm_up = 0; warm_up < 2; ++warm_up)
        for (const auto& frame : frames) culler.step(frame.view(), frame);
      EXPECT_GT(allocations.load(), 0u);
      const size_t before = allocations;
      uint64_t grown = 0;
      for (const auto& frame : frames) {
        culler.step(frame.view(), frame);
        grown += culler.counters().allocations_grown;
      }
      EXPECT_EQ(allocations - before, 0u)
          << "search " << static_cast<int>(search) << ", " << threads << " threads";
      EXPECT_EQ(grown, 0u);
    }
  }
}

}  // namespace
}  // namespace throng
