// Tests the counts of Part I and that no touching pair is missed.
#include "bench/paper/census.h"

#include <gtest/gtest.h>

namespace throng::paper::census_test {
namespace {

constexpr uint64_t kSeed = 1;
constexpr int kFrames = 100;

const std::vector<Object>& objects() {
  static const std::vector<Object> loaded = load_objects();
  return loaded;
}

uint64_t total(const std::vector<CensusTable>& tables, std::string_view name) {
  for (size_t v = 0; v < kMethods.size(); ++v) {
    if (kMethods[v] != name) continue;
    uint64_t sum = 0;
    for (const CensusTable& table : tables) sum += table[v].collisions.back();
    return sum;
  }
  ADD_FAILURE() << "no method " << name;
  return 0;
}

TEST(Census, CountsLikeThePaper) {
  const CensusTable table = take_census(objects(), kFrames, kSeed);
  for (size_t v = 0; v < kMethods.size(); ++v) {
    EXPECT_EQ(table[v].tests, 105u * 99u) << kMethods[v];
    EXPECT_EQ(table[v].updates, 15u * 99u) << kMethods[v];
    EXPECT_EQ(table[v].updates_paper(), 2u * 105u * 99u) << kMethods[v];
    EXPECT_EQ(table[v].primitives > 0, v == kExactMethod) << kMethods[v];
  }
}

/// The adult's box has the calibrated edge; the boxes of other models are equally crowded.
TEST(Census, AcceptsAnyModel) {
  EXPECT_EQ(part_one_box(objects(), kSeed).edge_m, 2.41);
  const std::string fixtures = std::string(THRONG_SOURCE_DIR) + "/tests/kinematics/fixtures/";
  const auto robot = load_objects(fixtures + "humanoid_description/urdf/humanoid.urdf");
  ASSERT_EQ(robot.size(), 19u);
  const CensusTable table = take_census(robot, kFrames, kSeed);
  const CensusTable adult = take_census(objects(), kFrames, kSeed);
  const auto rate = [](const Census& census) {
    return static_cast<double>(census.collisions.back()) / static_cast<double>(census.tests);
  };
  EXPECT_EQ(table[kSphereMethod].tests, 19u * 18 / 2 * 99);
  EXPECT_GT(rate(table[kSphereMethod]), 0.5 * rate(adult[kSphereMethod]));
  EXPECT_LT(rate(table[kSphereMethod]), 2 * rate(adult[kSphereMethod]));
  for (size_t v = 0; v < kMethods.size(); ++v) EXPECT_EQ(table[v].missed, 0u) << kMethods[v];
  // A single part is repeated as often as the adult has parts.
  EXPECT_EQ(load_objects(fixtures + "single.urdf").size(), 15u);
}

TEST(Census, HasThePapersNumberOfTests) {
  EXPECT_EQ(105u * 499u, 52395u);
  const std::vector<Object> three(objects().begin(), objects().begin() + 3);
  const CensusTable table = take_census(three, 500, kSeed);
  EXPECT_EQ(table[kSphereMethod].tests, 3u * 499u);
  EXPECT_EQ(table[kSphereMethod].updates, 3u * 499u);
}

TEST(Census, AccumulatesCollisionsByMark) {
  const CensusTable whole = take_census(objects(), kFrames, kSeed);
  for (size_t mark = 0; mark < kMarks; ++mark) {
    const int frames = kFrames / static_cast<int>(kMarks) * static_cast<int>(mark + 1);
    const CensusTable part = take_census(objects(), frames, kSeed);
    EXPECT_EQ(whole[kSphereMethod].collisions[mark], part[kSphereMethod].collisions.back())
        << "after " << frames << " frames, seed " << kSeed;
  }
}

TEST(Census, HasNoMisses) {
  for (const uint64_t seed : {1, 2, 3}) {
    const CensusTable table = take_census(objects(), kFrames, seed);
    const uint64_t truth = table[kExactMethod].collisions.back();
    for (size_t v = 0; v < kMethods.size(); ++v) {
      EXPECT_EQ(table[v].missed, 0u) << kMethods[v] << ", seed " << seed;
      EXPECT_EQ(table[v].false_positives, table[v].collisions.back() - truth)
          << kMethods[v] << ", seed " << seed;
    }
  }
}

TEST(Census, IsEqualForAnyThreadCount) {
  Workers one(1), two(2), five(5);
  const auto expected = take_censuses(objects(), 20, kSeed, 5, one);
  EXPECT_EQ(take_censuses(objects(), 20, kSeed, 5, two), expected);
  EXPECT_EQ(take_censuses(objects(), 20, kSeed, 5, five), expected);
  EXPECT_EQ(take_census(objects(), 20, kSeed + 3), expected[3]);
}

/// Table 2's order of volumes, where it holds for our parts; docs/paper.md lists the exceptions.
TEST(Census, KeepsTheMeanOrderOfTable2) {
  Workers workers(2);
  const auto tables = take_censuses(objects(), 150, kSeed, 6, workers);
  const auto expect_more = [&](const char* more, const char* less) {
    EXPECT_GT(total(tables, more), total(tables, less)) << more << " and " << less;
  };
  expect_more("sphere", "aabb");
  expect_more("aabb", "obb");
  for (const char* kdop : {"kdop26", "kdop14_refit", "kdop18_refit", "kdop26_refit"})
    expect_more("obb", kdop);
  for (const char* k : {"14", "18", "26"}) {
    expect_more((std::string("kdop") + k).c_str(), (std::string("ordop") + k).c_str());
    expect_more((std::string("kdop") + k).c_str(), (std::string("kdop") + k + "_refit").c_str());
    expect_more((std::string("ordop") + k).c_str(), "exact");
  }
  expect_more("ordop14", "ordop18");
  expect_more("ordop18", "ordop26");
}

}  // namespace
}  // namespace throng::paper::census_test
