// Tests that strategies of Part II agree on collisions and differ in their counts.
#include "bench/paper/strategies.h"

#include <gtest/gtest.h>

#include <set>

#include "culling/stages/slots.h"

namespace throng::paper::strategies_test {
namespace {

constexpr uint64_t kSeed = 3;
constexpr int kFrames = 20;

const std::vector<Object>& objects() {
  static const std::vector<Object> loaded = load_objects();
  return loaded;
}

using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;

Pairs pairs_of(const StrategyRun& run) {
  Pairs pairs;
  for (const SlotPair& pair : run.pairs()) pairs.emplace_back(pair.a, pair.b);
  return pairs;
}

Work work_of(Strategy strategy, size_t count, SimdTarget simd = SimdTarget::kBest) {
  StrategyRun run(strategy, objects(), count, kSeed, simd);
  for (int frame = 0; frame < kFrames; ++frame) run.frame();
  return run.work();
}

struct Oracle {
  explicit Oracle(const BoxDynamics& world) {
    using Spheres = Turned<Sphere>;
    using Ordops = Turned<Ordop<26>>;
    const auto spheres = fit_all<Spheres>(objects());
    const auto ordops = fit_all<Ordops>(objects());
    const auto margin_of = [](size_t kind) {
      return body_margin_m(reach_m(*objects()[kind].type));
    };
    TriangleCounters unused;
    for (uint32_t a = 0; a < world.size(); ++a)
      for (uint32_t b = a + 1; b < world.size(); ++b) {
        const size_t ka = a % objects().size(), kb = b % objects().size();
        const PartPose pa = world.pose(a), pb = world.pose(b);
        const float margin = margin_of(ka) + margin_of(kb);
        const bool spheres_overlap =
            Spheres::test(Spheres::update(spheres[ka], objects()[ka], pa),
                          Spheres::update(spheres[kb], objects()[kb], pb), margin, unused);
        const bool ordops_overlap =
            Ordops::test(Ordops::update(ordops[ka], objects()[ka], pa),
                         Ordops::update(ordops[kb], objects()[kb], pb), margin, unused);
        if (spheres_overlap) ++sphere_pairs;
        if (ordops_overlap) ordop_pairs.emplace_back(a, b);
        if (spheres_overlap && ordops_overlap) both.emplace_back(a, b);
      }
  }
  size_t sphere_pairs = 0;
  Pairs ordop_pairs, both;
};

TEST(Strategies, MatchTheOracle) {
  const size_t count = 120;
  StrategyRun sphere(Strategy::kSphere, objects(), count, kSeed);
  StrategyRun ordop(Strategy::kOrdop, objects(), count, kSeed);
  StrategyRun one(Strategy::kHybridOne, objects(), count, kSeed);
  StrategyRun all(Strategy::kHybridAll, objects(), count, kSeed);
  StrategyRun two(Strategy::kTwoPass, objects(), count, kSeed);
  StrategyRun grid(Strategy::kTwoPassGrid, objects(), count, kSeed);
  size_t found = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (StrategyRun* run : {&sphere, &ordop, &one, &all, &two, &grid}) run->frame();
    const Oracle oracle(sphere.world());
    found += oracle.both.size();
    ASSERT_EQ(sphere.pairs().size(), oracle.sphere_pairs) << "frame " << frame;
    ASSERT_EQ(pairs_of(ordop), oracle.ordop_pairs) << "frame " << frame;
    ASSERT_EQ(pairs_of(all), oracle.both) << "frame " << frame;
    ASSERT_EQ(pairs_of(two), oracle.both) << "frame " << frame;
    ASSERT_EQ(pairs_of(grid), oracle.both) << "frame " << frame;
    Pairs of_interest;
    for (const auto& pair : oracle.both)
      if (pair.first == 0) of_interest.push_back(pair);
    ASSERT_EQ(pairs_of(one), of_interest) << "frame " << frame;
  }
  EXPECT_GT(found, 0u);
}

TEST(Strategies, CountTheWorkOfFourObjects) {
  // 4 objects have 6 pairs, 3 of them with object 0.
  const Work control = work_of(Strategy::kControl, 4);
  EXPECT_EQ(control, Work{});
  const Work sphere = work_of(Strategy::kSphere, 4);
  EXPECT_EQ(sphere.sphere_updates, 4u * kFrames);
  EXPECT_EQ(sphere.sphere_tests, 6u * kFrames);
  EXPECT_EQ(sphere.ordop_updates + sphere.ordop_tests, 0u);
  const Work ordop = work_of(Strategy::kOrdop, 4);
  EXPECT_EQ(ordop.ordop_updates, 4u * kFrames);
  EXPECT_EQ(ordop.ordop_tests, 6u * kFrames);
  EXPECT_EQ(ordop.sphere_updates + ordop.sphere_tests, 0u);
  const Work one = work_of(Strategy::kHybridOne, 4);
  EXPECT_EQ(one.sphere_updates, 4u * kFrames);
  EXPECT_EQ(one.sphere_tests, 3u * kFrames);
  const Work all = work_of(Strategy::kHybridAll, 4);
  EXPECT_EQ(all.sphere_updates, 4u * kFrames);
  EXPECT_EQ(all.ordop_updates, 4u * kFrames);
  EXPECT_EQ(all.sphere_tests, 6u * kFrames);
  EXPECT_EQ(all.ordop_tests, sphere.passed);
}

TEST(Strategies, TwoPassUpdatesSurvivorsOnce) {
  StrategyRun sphere(Strategy::kSphere, objects(), 200, kSeed);
  StrategyRun two(Strategy::kTwoPass, objects(), 200, kSeed);
  uint64_t survivors = 0, tests = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    sphere.frame();
    two.frame();
    std::set<uint32_t> paired;
    for (const SlotPair& pair : sphere.pairs()) paired.insert({pair.a, pair.b});
    survivors += paired.size();
    tests += sphere.pairs().size();
  }
  EXPECT_EQ(two.work().ordop_updates, survivors);
  EXPECT_EQ(two.work().ordop_tests, tests);
  EXPECT_GT(survivors, 0u);
  EXPECT_LT(survivors, uint64_t{200} * kFrames);
}

TEST(Strategies, CountEquallyOnEverySimdTarget) {
  for (const Strategy strategy : {Strategy::kSphere, Strategy::kTwoPass, Strategy::kTwoPassGrid}) {
    const Work expected = work_of(strategy, 333, SimdTarget::kScalar);
    EXPECT_GT(expected.passed, 0u);
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      const Work found = work_of(strategy, 333, target);
      EXPECT_EQ(found.passed, expected.passed) << name_of(target);
      EXPECT_EQ(found.tests(), expected.tests()) << name_of(target);
      EXPECT_EQ(found.updates(), expected.updates()) << name_of(target);
    }
  }
}

/// Fig. 13 in counted work, for any cost of the volumes: each strategy adds work to the previous
/// one. Or-DOPs alone cost more because of their tests.
TEST(Strategies, OrderTheirWorkAsInFigure13) {
  const Work one = work_of(Strategy::kHybridOne, 500);
  const Work sphere = work_of(Strategy::kSphere, 500);
  const Work two = work_of(Strategy::kTwoPass, 500);
  const Work all = work_of(Strategy::kHybridAll, 500);
  EXPECT_LT(one.sphere_tests + one.ordop_tests, sphere.sphere_tests);
  EXPECT_EQ(two.sphere_tests, sphere.sphere_tests);
  EXPECT_GT(two.ordop_tests, 0u);
  EXPECT_EQ(all.ordop_tests, two.ordop_tests);
  EXPECT_EQ(all.sphere_updates, two.sphere_updates);
  EXPECT_GT(all.ordop_updates, two.ordop_updates);
}

TEST(Strategies, CountTrianglePairs) {
  StrategyRun run(Strategy::kTwoPass, objects(), 200, kSeed);
  size_t touching = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    run.frame();
    touching += run.count_primitives();
  }
  EXPECT_GT(touching, 0u);
  EXPECT_LE(touching, run.work().passed);
  EXPECT_GE(run.work().primitives, run.work().passed);
}

}  // namespace
}  // namespace throng::paper::strategies_test
