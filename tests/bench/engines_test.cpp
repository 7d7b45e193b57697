// Tests that all engines list the same pairs as brute force: only then their times are printed.
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/comparison.h"
#include "bench/crowd.h"
#include "bench/engines/engine.h"

namespace throng::bench::engines_test {
namespace {

std::vector<BoxPair> brute_force_pairs(const BoxList& list) {
  std::vector<BoxPair> out;
  for (uint32_t a = 0; a < list.boxes.size(); ++a)
    for (uint32_t b = a + 1; b < list.boxes.size(); ++b)
      if (a / list.parts != b / list.parts && overlap(list.boxes[a], list.boxes[b]))
        out.push_back({a, b});
  return out;
}

std::vector<std::string> built_in() {
  std::vector<std::string> names;
  for (const EngineKind& kind : engine_kinds())
    if (kind.make != nullptr) names.emplace_back(kind.name);
  return names;
}

class BenchCrowd : public testing::Test {
 protected:
  BenchCrowd() : crowd(load_model(adult_urdf()), {.avatars = 70, .per_m2 = 4, .seed = 3}) {}
  Crowd crowd;
};

TEST_F(BenchCrowd, ReferenceEqualsBruteForce) {
  CrowdBoxes boxes(crowd, crowd.body_type());
  for (int frame = 0; frame < 3; ++frame) {
    for (int step = 0; step < 30; ++step) crowd.advance();
    const BoxList list = boxes.compute();
    const std::vector<BoxPair> expected = brute_force_pairs(list);
    EXPECT_GT(expected.size(), 100u);
    EXPECT_EQ(reference_pairs(list), expected) << "frame " << frame;
  }
}

TEST_F(BenchCrowd, BoundsPlacedVerticesTightly) {
  const auto type = crowd.body_type();
  CrowdBoxes boxes(crowd, type);
  const BoxList list = boxes.compute();
  const size_t parts = list.parts;
  for (size_t i = 0; i < list.boxes.size(); ++i) {
    const Eigen::Isometry3d pose = to_isometry(boxes.poses()[i]);
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
    for (const Eigen::Vector3f& point : type->parts()[i % parts].points) {
      const Eigen::Vector3d placed =
          pose * point.cast<double>() + crowd.view().roots[i / parts].position_m;
      low = low.cwiseMin(placed);
      high = high.cwiseMax(placed);
    }
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(static_cast<double>(list.boxes[i].min_m[axis]), low[axis], 1e-5) << "box " << i;
      ASSERT_NEAR(static_cast<double>(list.boxes[i].max_m[axis]), high[axis], 1e-5) << "box " << i;
    }
  }
}

TEST_F(BenchCrowd, EnginesMatchBruteForceInEveryFrame) {
  CrowdBoxes boxes(crowd, crowd.body_type());
  for (const EngineKind& kind : engine_kinds()) {
    if (kind.make == nullptr) continue;
    for (const int threads : {1, 2}) {
      const std::unique_ptr<Engine> engine = kind.make(threads);
      engine->build(boxes.compute());
      std::vector<BoxPair> found = {{7, 7}};  // must be replaced
      for (int frame = 0; frame < 20; ++frame) {
        crowd.advance();
        const BoxList list = boxes.compute();
        engine->update(list);
        engine->pairs(found);
        std::sort(found.begin(), found.end());
        const std::vector<BoxPair> expected = brute_force_pairs(list);
        ASSERT_EQ(found.size(), expected.size()) << kind.name << ", frame " << frame;
        ASSERT_EQ(found, expected) << kind.name << ", frame " << frame;
      }
    }
  }
}

TEST(BenchComparison, ComparesAllBuiltInEngines) {
  const BenchResult result = compare({.avatars = 60,
                                      .per_m2 = 4,
                                      .frames = 3,
                                      .engines = {"fcl", "embree", "bullet", "cgal", "ode"}},
                                     [](const std::string&) {});
  EXPECT_EQ(result.engines.size(), built_in().size());
  EXPECT_EQ(result.engines.size() + result.skipped.size(), 5u);
  EXPECT_GT(result.throng.ms.median, 0);
  EXPECT_GT(result.throng.pairs, 0u);
  EXPECT_GT(result.throng.box_pairs, result.throng.pairs);
  for (const EngineResult& engine : result.engines) {
    EXPECT_TRUE(engine.agrees) << engine.name << " lists " << engine.pairs << " of "
                               << result.reference_pairs;
    EXPECT_GT(engine.ratio_boxes, engine.ratio) << engine.name;
  }
  const bool has_fcl = !result.engines.empty() && result.engines[0].name == "fcl";
  EXPECT_EQ(result.ratio_fcl() > 0, has_fcl);
  EXPECT_EQ(result.ratio_fastest() > 0, !result.engines.empty());
}

TEST(BenchComparison, IgnoresEnginesThatDisagree) {
  BenchResult result;
  result.engines.resize(2);
  result.engines[0] = {.name = "wrong", .ms = {1, 1, 1}, .agrees = false, .ratio = 2};
  result.engines[1] = {.name = "fcl", .ms = {3, 3, 3}, .agrees = true, .ratio = 6};
  EXPECT_EQ(result.ratio_fastest(), 6);
  EXPECT_EQ(result.ratio_fcl(), 6);
  result.engines[1].agrees = false;
  EXPECT_EQ(result.ratio_fastest(), 0);
  EXPECT_EQ(result.ratio_fcl(), 0);
}

TEST(BenchAgeing, DoesTheWorkOfAFreshStructure) {
  const AgeingResult result = age({.avatars = 80, .per_m2 = 4, .frames = 3, .engines = built_in()},
                                  40, [](const std::string&) {});
  EXPECT_GT(result.fresh_work, 1000u);
  EXPECT_EQ(result.aged_work, result.fresh_work);
  EXPECT_EQ(result.engines.size(), built_in().size());
  for (const AgedEngine& engine : result.engines) EXPECT_TRUE(engine.agrees) << engine.name;
}

TEST(TimeStats, UsesSortedValues) {
  const TimeStats stats = time_stats_of({5, 1, 3});
  EXPECT_EQ(stats.min, 1);
  EXPECT_EQ(stats.median, 3);
  EXPECT_EQ(stats.p95, 5);
  EXPECT_EQ(time_stats_of({4, 2}).median, 3);
  EXPECT_EQ(time_stats_of({}).median, 0);
}

}  // namespace
}  // namespace throng::bench::engines_test
