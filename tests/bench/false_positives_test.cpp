// Tests the false-positive table: no misses, fewer reports of tighter volumes, consistent sums.
#include <gtest/gtest.h>

#include <map>

#include "bench/comparison.h"
#include "bench/workbench/volume_trials.h"

namespace throng::bench::false_positives_test {
namespace {

class FalsePositiveTable : public testing::Test {
 protected:
  static const FalsePositives& table() {
    static const FalsePositives result = [] {
      BenchOptions options{.avatars = 80, .per_m2 = 4, .seed = 5};
      return count_false_positives(*make_crowd(options), project_volumes(), {.frames = 2},
                                   [](const std::string&) {});
    }();
    return result;
  }
  static uint64_t reported(const std::string& name) {
    for (const VolumeReport& volume : table().volumes)
      if (volume.name == name) return volume.reported;
    throw std::runtime_error("no volume " + name);
  }
};

TEST_F(FalsePositiveTable, HasNoMissedPair) {
  EXPECT_GT(table().touching, 50u);
  for (const VolumeReport& volume : table().volumes) {
    EXPECT_EQ(volume.missed, 0u) << volume.name;
    EXPECT_GE(volume.reported, table().touching) << volume.name;
  }
}

TEST_F(FalsePositiveTable, ReportsLessWithMoreDirections) {
  EXPECT_GE(reported("ordop14"), reported("ordop18"));
  EXPECT_GE(reported("ordop18"), reported("ordop26"));
  EXPECT_GE(reported("aabb"), reported("aabb_vertices"));
  EXPECT_GE(reported("aabb_vertices"), reported("kdop14_vertices"));
  EXPECT_GE(reported("kdop26"), reported("kdop26_vertices"));
  EXPECT_GT(reported("sphere"), reported("ordop26"));
  // Its margins are not those of the volume alone: a pair more or less is possible.
  EXPECT_LT(reported("pipeline"), reported("ordop14"));
}

TEST_F(FalsePositiveTable, MatrixSumsToTheTable) {
  PartCell sum;
  for (size_t a = 0; a < table().parts.size(); ++a)
    for (size_t b = 0; b < table().parts.size(); ++b) {
      const PartCell& cell = table().cell(a, b);
      if (a > b) {
        EXPECT_EQ(cell.tests, 0u) << a << ", " << b;
      } else {
        EXPECT_GT(cell.tests, 0u) << a << ", " << b;
      }
      EXPECT_LE(cell.touching, cell.passed);
      EXPECT_LE(cell.passed, cell.tests);
      sum.tests += cell.tests;
      sum.passed += cell.passed;
      sum.touching += cell.touching;
    }
  EXPECT_EQ(sum.tests, table().tests);
  EXPECT_EQ(sum.passed, reported("ordop26"));
  EXPECT_EQ(sum.touching, table().touching);
  EXPECT_EQ(table().tests, 225 * table().avatar_pairs);
}

}  // namespace
}  // namespace throng::bench::false_positives_test
