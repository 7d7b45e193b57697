// BudgetedPass reports every touching pair, is repeatable, and refines urgent pairs first.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "culling/culling.h"
#include "tests/culling/random_bodies.h"
#include "tests/culling/truth.h"

namespace throng::budget_test {
namespace {

using test::RandomBodies;
using test::Subset;

constexpr uint64_t kBudgets[] = {0, 1, 17, 400, 3000, 20'000, 150'000, 1'000'000, UINT64_MAX};

RandomBodies dense_world(uint64_t seed) { return {seed, 60, 3, Eigen::Vector3d::Zero()}; }

/// Complete result of a frame.
struct Result {
  std::vector<PairKey> pairs;
  std::vector<uint8_t> levels;
  CullingCounters counters;
  uint64_t hash = 0;
};

Result result_of(const Culler& culler) {
  return {{culler.pairs().begin(), culler.pairs().end()},
          {culler.levels().begin(), culler.levels().end()},
          culler.counters(),
          culler.hash()};
}

Result one_frame(const RandomBodies& world, const CullerOptions& options, int threads = 1) {
  Workers workers(threads);
  Culler culler(world.types, options, workers);
  culler.step(world.view(), world);
  return result_of(culler);
}

uint64_t tests_of(const CullingCounters& c) {
  return c.body_box.tests + c.part_box.tests + c.part_volume.tests + c.triangles.tests;
}

bool whole_body(const PairKey& pair) {
  return pair.part_a() == kWholeBody && pair.part_b() == kWholeBody;
}

TEST(BudgetedPass, ReportsEveryTouchingPairWithAnyBudget) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const RandomBodies world = dense_world(seed);
    const std::vector<PairKey> truth = test::touching_by_brute_force(world);
    ASSERT_GT(truth.size(), 20u);
    for (const bool exact : {false, true}) {
      for (const uint64_t budget : kBudgets) {
        const Result found = one_frame(world, {.exact = exact, .budget_tests = budget});
        for (const PairKey& pair : truth) {
          const PairKey whole(pair.a(), pair.b(), kWholeBody, kWholeBody);
          const auto has = [&](const PairKey& key) {
            return std::binary_search(found.pairs.begin(), found.pairs.end(), key);
          };
          ASSERT_TRUE(has(pair) || has(whole))
              << "seed " << seed << ", budget " << budget << ": bodies " << pair.a() << " and "
              << pair.b() << " touch";
        }
      }
    }
  }
}

TEST(BudgetedPass, ReportsEveryTouchingPairWithoutTime) {
  const RandomBodies world = dense_world(5);
  const Result found = one_frame(world, {.budget_ms = 0});
  for (const PairKey& pair : test::touching_by_brute_force(world))
    EXPECT_TRUE(std::binary_search(found.pairs.begin(), found.pairs.end(),
                                   PairKey(pair.a(), pair.b(), kWholeBody, kWholeBody)));
  EXPECT_EQ(tests_of(found.counters), 0u);
  EXPECT_EQ(found.counters.posed_bodies, found.counters.body_box.updates);
  EXPECT_EQ(found.counters.levels[0], found.pairs.size());
}

TEST(BudgetedPass, DecidesAllPairsWithALargeBudget) {
  const RandomBodies world(6, 300, 5, Eigen::Vector3d::Zero());
  for (const bool exact : {false, true}) {
    const Result plain = one_frame(world, {.exact = exact});
    EXPECT_TRUE(plain.levels.empty());
    for (const CullerOptions& options :
         {CullerOptions{.exact = exact, .budget_ms = 1e6},
          CullerOptions{.exact = exact, .budget_tests = UINT64_MAX},
          CullerOptions{.exact = exact, .budget_ms = 1e6, .budget_tests = 1u << 30}}) {
      const Result found = one_frame(world, options, 2);
      EXPECT_TRUE(found.pairs == plain.pairs);
      const auto last =
          static_cast<uint8_t>(exact ? PairLevel::kTriangles : PairLevel::kPartVolume);
      EXPECT_EQ(found.levels, std::vector<uint8_t>(found.pairs.size(), last));
      EXPECT_EQ(tests_of(found.counters), tests_of(plain.counters));
      EXPECT_EQ(found.counters.levels, plain.counters.levels);
    }
  }
}

TEST(BudgetedPass, NeverExceedsItsBudgetOfTests) {
  for (const bool exact : {false, true}) {
    for (const VolumeKind volume : {VolumeKind::kOrdop26, VolumeKind::kSphere}) {
      const RandomBodies world(7, 300, 5, Eigen::Vector3d::Zero());
      const auto tests = [&](std::optional<uint64_t> budget) {
        return tests_of(
            one_frame(world, {.part_volume = volume, .exact = exact, .budget_tests = budget})
                .counters);
      };
      const uint64_t all = tests({});
      for (const uint64_t budget : kBudgets) {
        const uint64_t made = tests(budget);
        EXPECT_LE(made, budget);
        // The rest of a wave's budget goes to the next one, so little remains unused.
        EXPECT_GE(made, std::min(all, budget - std::min(budget, uint64_t{37} * 37)));
      }
    }
  }
}

/// For each budget, over frames in which bodies appear and disappear.
TEST(BudgetedPass, GivesTheSameResultForSearchesTargetsAndThreads) {
  for (uint64_t seed = 11; seed <= 13; ++seed) {
    const RandomBodies world(seed, 500, 7, Eigen::Vector3d(10'000, -7'000, 0));
    for (const uint64_t budget :
         {uint64_t{0}, uint64_t{777}, uint64_t{30'000}, uint64_t{900'000}}) {
      const auto run = [&](PairSearch search, SimdTarget simd, int threads) {
        Workers workers(threads);
        Culler culler(
            world.types,
            {.exact = seed == 13, .pair_search = search, .simd = simd, .budget_tests = budget},
            workers);
        for (uint64_t frame = 0; frame < 3; ++frame) {
          const Subset subset(world, 100 + frame);
          culler.step(subset.view(), Subset::Source(subset));
        }
        return result_of(culler);
      };
      const Result reference = run(PairSearch::kBrute, SimdTarget::kScalar, 1);
      ASSERT_FALSE(reference.pairs.empty());
      for (const PairSearch search : {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute}) {
        for (const SimdTarget target : simd_targets_of_this_machine()) {
          for (const int threads : {1, 3}) {
            const Result found = run(search, target, threads);
            EXPECT_TRUE(found.pairs == reference.pairs && found.levels == reference.levels &&
                        found.hash == reference.hash &&
                        tests_of(found.counters) == tests_of(reference.counters))
                << "seed " << seed << ", budget " << budget << ", search "
                << static_cast<int>(search) << ", " << name_of(target) << ", " << threads
                << " threads";
          }
        }
      }
    }
  }
}

TEST(BudgetedPass, ReportsEveryLevelAndCountsIt) {
  const RandomBodies world = dense_world(21);
  std::set<uint8_t> seen;
  for (uint64_t budget = 100; budget < 300'000; budget += budget / 5) {
    const Result found = one_frame(world, {.exact = true, .budget_tests = budget});
    ASSERT_EQ(found.levels.size(), found.pairs.size());
    std::array<uint64_t, kPairLevels> levels{};
    for (size_t i = 0; i < found.pairs.size(); ++i) {
      ++levels[found.levels[i]];
      seen.insert(found.levels[i]);
      const auto level = static_cast<PairLevel>(found.levels[i]);
      if (level == PairLevel::kSphere) {
        EXPECT_TRUE(whole_body(found.pairs[i]));
      } else if (level != PairLevel::kBox) {
        EXPECT_FALSE(whole_body(found.pairs[i]));
      }
    }
    EXPECT_EQ(levels, found.counters.levels);
    EXPECT_TRUE(std::is_sorted(found.pairs.begin(), found.pairs.end()));
    EXPECT_EQ(std::adjacent_find(found.pairs.begin(), found.pairs.end()), found.pairs.end());
  }
  EXPECT_EQ(seen, (std::set<uint8_t>{0, 1, 2, 3}));
}

/// Spheres only, all of one size, so that the overlap depth is easy to compute.
struct Spheres : RandomBodies {
  explicit Spheres(uint64_t seed) : RandomBodies(seed, 200, 5, Eigen::Vector3d::Zero()) {
    RandomBodies only(seed, 0, 1, Eigen::Vector3d::Zero());
    for (size_t i = 0; i < ids.size(); ++i) {
      if (type_of[i] != 0) continue;
      only.ids.push_back(ids[i]);
      only.type_of.push_back(0);
      only.scales.push_back(scales[i]);
      only.roots.push_back(roots[i]);
      only.first_pose.push_back(first_pose[i]);
    }
    only.all_poses = all_poses;
    static_cast<RandomBodies&>(*this) = only;
    for (size_t i = 0; i < ids.size(); ++i) index[ids[i]] = i;
  }
  double depth_m(const PairKey& pair) const {
    const size_t a = index.at(pair.a()), b = index.at(pair.b());
    const double reach = double{scales[a] + scales[b]} * double{types[0]->sphere().radius_m};
    return reach - (roots[a].position_m - roots[b].position_m).norm();
  }
  std::map<uint32_t, size_t> index;
};

TEST(BudgetedPass, RefinesTheDeepestOverlapsFirst) {
  const Spheres world(31);
  for (const uint64_t budget : {uint64_t{1000}, uint64_t{5000}, uint64_t{20'000}}) {
    const Result found = one_frame(world, {.budget_tests = budget});
    double shallowest_decided = 1e9, deepest_left = -1e9;
    for (size_t i = 0; i < found.pairs.size(); ++i) {
      const double depth = world.depth_m(found.pairs[i]);
      if (found.levels[i] == static_cast<uint8_t>(PairLevel::kPartVolume))
        shallowest_decided = std::min(shallowest_decided, depth);
      if (found.levels[i] == static_cast<uint8_t>(PairLevel::kSphere))
        deepest_left = std::max(deepest_left, depth);
    }
    ASSERT_LT(shallowest_decided, 1e9) << "budget " << budget;
    ASSERT_GT(deepest_left, -1e9) << "budget " << budget;
    EXPECT_GE(shallowest_decided, deepest_left - 1e-4) << "budget " << budget;
  }
}

/// Bodies do not move: pairs decided to touch are refined first in the next frame and stay decided.
TEST(BudgetedPass, RefinesPreviousContactsFirst) {
  const Spheres world(32);
  for (const uint64_t budget : {uint64_t{1000}, uint64_t{5000}, uint64_t{20'000}}) {
    Workers workers(2);
    Culler culler(world.types, {.budget_tests = budget}, workers);
    std::vector<PairKey> decided;
    for (int frame = 0; frame < 5; ++frame) {
      culler.step(world.view(), world);
      for (const PairKey& pair : decided)
        EXPECT_TRUE(std::binary_search(culler.pairs().begin(), culler.pairs().end(), pair));
      const size_t before = decided.size();
      decided.clear();
      for (size_t i = 0; i < culler.pairs().size(); ++i)
        if (culler.levels()[i] == static_cast<uint8_t>(PairLevel::kPartVolume))
          decided.push_back(culler.pairs()[i]);
      EXPECT_GE(decided.size(), before) << "frame " << frame;
      EXPECT_GT(decided.size(), 0u);
    }
  }
}

TEST(BudgetedPass, PairsBeginAndEndEventsWithTheirLevels) {
  const RandomBodies world(41, 200, 4, Eigen::Vector3d::Zero());
  for (const bool by_clock : {false, true}) {
    Workers workers(2);
    const CullerOptions options =
        by_clock ? CullerOptions{.budget_ms = 0.3} : CullerOptions{.budget_tests = 40'000};
    Culler culler(world.types, options, workers);
    std::map<PairKey, uint8_t> open;
    const auto take = [&] {
      for (const auto& [pair, kind, event_level] : culler.events()) {
        const auto level = static_cast<uint8_t>(event_level);
        if (kind == EventKind::kBegin) {
          EXPECT_TRUE(open.emplace(pair, level).second) << "begun twice";
        } else {
          ASSERT_EQ(open.count(pair), 1u) << "end without begin";
          EXPECT_EQ(open[pair], level) << "an end event has the level last reported";
          open.erase(pair);
        }
      }
      ASSERT_EQ(open.size(), culler.pairs().size());
      ASSERT_EQ(culler.levels().size(), culler.pairs().size());
      for (size_t i = 0; i < culler.pairs().size(); ++i) {
        ASSERT_EQ(open.count(culler.pairs()[i]), 1u);
        open[culler.pairs()[i]] = culler.levels()[i];
      }
    };
    for (uint64_t frame = 0; frame < 20; ++frame) {
      const Subset subset(world, 100 + frame);
      culler.step(subset.view(), Subset::Source(subset));
      take();
    }
    culler.finish();
    take();
    EXPECT_TRUE(open.empty());
  }
}

}  // namespace
}  // namespace throng::budget_test
