// Counts every operator new of the process: culling allocates nothing for frames of a known size.
#include <gtest/gtest.h>

#include "culling/culling.h"
#include "tests/allocation_counter.h"
#include "tests/culling/random_bodies.h"

namespace throng::allocation_test {
namespace {

void expect_none(const std::vector<test::RandomBodies>& frames, const CullerOptions& options,
                 int threads) {
  Workers workers(threads);
  // The frames differ only in poses, so one set of types serves all.
  Culler culler(frames[0].types, options, workers);
  for (int warm_up = 0; warm_up < 2; ++warm_up)
    for (const auto& frame : frames) culler.step(frame.view(), frame);
  EXPECT_GT(test::allocations_so_far(), 0u);
  const size_t before = test::allocations_so_far();
  uint64_t grown = 0;
  for (const auto& frame : frames) {
    culler.step(frame.view(), frame);
    grown += culler.counters().buffers_grown;
  }
  EXPECT_EQ(test::allocations_so_far() - before, 0u)
      << "search " << static_cast<int>(options.pair_search) << ", " << threads << " threads, "
      << (options.budget_tests ? "with" : "without") << " a budget";
  EXPECT_EQ(grown, 0u);
}

TEST(Culler, AllocatesNothingForKnownFrames) {
  std::vector<test::RandomBodies> frames;
  for (uint64_t seed = 1; seed <= 5; ++seed)
    frames.emplace_back(seed, 400, 6, Eigen::Vector3d::Zero());
  for (const PairSearch search : {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute}) {
    for (const int threads : {1, 3}) {
      CullerOptions options{.exact = search == PairSearch::kGrid, .pair_search = search};
      expect_none(frames, options, threads);
      options.budget_tests = 100'000;
      expect_none(frames, options, threads);
    }
  }
}

TEST(Culler, AllocatesNothingForDistancesOfKnownFrames) {
  std::vector<test::RandomBodies> frames;
  for (uint64_t seed = 1; seed <= 3; ++seed)
    frames.emplace_back(seed, 60, 3, Eigen::Vector3d::Zero());
  for (const bool exact : {false, true}) {
    for (const int threads : {1, 3}) {
      CullerOptions options{.exact = exact, .proximity = {0.2f, 0.4f, 0.1}};
      expect_none(frames, options, threads);
      options.budget_tests = 100;
      expect_none(frames, options, threads);
    }
  }
}

TEST(Culler, AllocatesNothingForContactPointsOfKnownFrames) {
  std::vector<test::RandomBodies> frames;
  for (uint64_t seed = 1; seed <= 3; ++seed)
    frames.emplace_back(seed, 60, 3, Eigen::Vector3d::Zero());
  for (const float margin_m : {0.0f, 0.2f}) {
    for (const int threads : {1, 3}) {
      CullerOptions options{.exact = true, .proximity = {margin_m, 0, 0.1, true}};
      expect_none(frames, options, threads);
      options.budget_tests = 100;
      expect_none(frames, options, threads);
    }
  }
}

}  // namespace
}  // namespace throng::allocation_test
