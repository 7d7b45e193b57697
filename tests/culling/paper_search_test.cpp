// PaperSearch finds the same pairs with all strategies that end in the same volume.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/errors.h"
#include "culling/strategies/paper_culler.h"
#include "tests/culling/random_bodies.h"
#include "tests/culling/truth.h"

namespace throng::paper_search_test {
namespace {

using test::RandomBodies;
using test::touching_by_brute_force;

RandomBodies dense_world(uint64_t seed) { return {seed, 60, 3, Eigen::Vector3d(5000, -300, 0)}; }

struct Answer {
  std::vector<PairKey> pairs;
  std::vector<uint8_t> levels;
  CullingCounters counters;
};

Answer run(const RandomBodies& world, const CullerOptions& options, Strategy strategy) {
  Workers workers(1);
  const auto culler = make_culler(world.types, strategy, options, workers);
  culler->step(world.view(), world);
  const CullingResult frame = culler->frame();
  return {{frame.pairs.begin(), frame.pairs.end()},
          {frame.levels.begin(), frame.levels.end()},
          *frame.counters};
}

std::vector<PairKey> pairs_of(const RandomBodies& world, CullerOptions options, Strategy strategy,
                              PairSearch search = PairSearch::kBrute) {
  options.pair_search = search;
  return run(world, options, strategy).pairs;
}

bool includes(const std::vector<PairKey>& more, const std::vector<PairKey>& fewer) {
  return std::includes(more.begin(), more.end(), fewer.begin(), fewer.end());
}

TEST(PaperSearch, FindsTheSamePairsWithTheSameFinalVolume) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const RandomBodies world = dense_world(seed);
    const std::vector<PairKey> truth = touching_by_brute_force(world);
    for (const VolumeKind volume : kAllVolumes) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << name_of(volume));
      const CullerOptions options{.part_volume = volume};
      const auto two_pass = pairs_of(world, options, Strategy::kTwoPass);
      EXPECT_TRUE(includes(two_pass, truth));
      EXPECT_TRUE(pairs_of(world, options, Strategy::kHybridAll) == two_pass);
      for (const PairSearch search : {PairSearch::kGrid, PairSearch::kSweep})
        EXPECT_TRUE(pairs_of(world, options, Strategy::kTwoPass, search) == two_pass);
      // Spheres exclude pairs that a loose part volume alone would report.
      EXPECT_TRUE(includes(pairs_of(world, options, Strategy::kVolume), two_pass));
      std::vector<PairKey> of_interest;
      for (const PairKey& pair : two_pass)
        if (pair.a() == world.ids.front()) of_interest.push_back(pair);
      EXPECT_TRUE(pairs_of(world, options, Strategy::kHybridOne) == of_interest);
      EXPECT_TRUE(pairs_of(world, options, Strategy::kNone).empty());
    }
  }
}

TEST(PaperSearch, FindsTheTruthWithTriangles) {
  const RandomBodies world = dense_world(4);
  const std::vector<PairKey> truth = touching_by_brute_force(world);
  ASSERT_GT(truth.size(), 20u);
  for (const Strategy strategy :
       {Strategy::kPipeline, Strategy::kVolume, Strategy::kHybridAll, Strategy::kTwoPass})
    EXPECT_TRUE(pairs_of(world, {.exact = true}, strategy) == truth) << name_of(strategy);
}

TEST(PaperSearch, ReportsWholeBodiesForSpheresOnly) {
  const RandomBodies world = dense_world(5);
  const Answer found = run(world, {}, Strategy::kSphere);
  EXPECT_EQ(found.levels, std::vector<uint8_t>(found.pairs.size(), 0));
  EXPECT_EQ(found.counters.levels[0], found.pairs.size());
  EXPECT_EQ(found.counters.posed_bodies, 0u);
  for (const PairKey& pair : touching_by_brute_force(world))
    EXPECT_TRUE(std::binary_search(found.pairs.begin(), found.pairs.end(),
                                   PairKey(pair.a(), pair.b(), kWholeBody, kWholeBody)));
  EXPECT_THROW(PaperCuller(world.types, Strategy::kSphere, {.exact = true}), InputError);
}

/// The kernel with the directions of one or-DOP as lanes equals the scalar reference bit for bit.
TEST(PaperSearch, GivesTheSameResultForEverySimdTarget) {
  for (uint64_t seed = 11; seed <= 12; ++seed) {
    const RandomBodies world(seed, 100, 3, Eigen::Vector3d::Zero());
    for (const VolumeKind volume :
         {VolumeKind::kOrdop14, VolumeKind::kOrdop18, VolumeKind::kOrdop26}) {
      const auto answer = [&](SimdTarget target) {
        return run(world, {.part_volume = volume, .simd = target}, Strategy::kVolume);
      };
      const Answer reference = answer(SimdTarget::kScalar);
      ASSERT_GT(reference.pairs.size(), 100u);
      ASSERT_LT(reference.pairs.size(), reference.counters.part_volume.tests / 2);
      for (const SimdTarget target : simd_targets_of_this_machine()) {
        const Answer found = answer(target);
        EXPECT_TRUE(found.pairs == reference.pairs) << name_of(volume) << ", " << name_of(target);
        EXPECT_EQ(found.counters.part_volume.tests, reference.counters.part_volume.tests);
      }
    }
  }
}

TEST(PaperSearch, UpdatesTheVolumesOfSurvivorsOnly) {
  const RandomBodies world(21, 300, 20, Eigen::Vector3d::Zero());
  const auto counters = [&](Strategy strategy) {
    return run(world, {.pair_search = PairSearch::kBrute}, strategy).counters;
  };
  uint64_t parts = 0;
  for (const uint16_t type : world.type_of)
    parts += static_cast<uint64_t>(world.types[type]->part_count());
  const CullingCounters all = counters(Strategy::kHybridAll), two = counters(Strategy::kTwoPass);
  EXPECT_EQ(all.part_volume.updates, parts);
  EXPECT_LT(two.part_volume.updates, parts);
  EXPECT_GT(two.part_volume.updates, 0u);
  EXPECT_EQ(all.body_sphere.updates, world.ids.size());
  EXPECT_EQ(all.body_sphere.passed, two.body_sphere.passed);
  EXPECT_EQ(all.part_volume.tests, two.part_volume.tests);
  EXPECT_EQ(counters(Strategy::kVolume).body_sphere.tests, 0u);
}

TEST(Strategy, ReadsItsNames) {
  for (const Strategy strategy : kAllStrategies)
    EXPECT_EQ(strategy_of(name_of(strategy)), strategy);
  EXPECT_FALSE(strategy_of("three-pass").has_value());
}

}  // namespace
}  // namespace throng::paper_search_test
