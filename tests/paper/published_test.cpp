// Tests the paper's printed numbers: they follow their formula and show what was counted.
#include "bench/paper/published.h"

#include <gtest/gtest.h>

#include "bench/paper/methods.h"

namespace throng::paper::published_test {
namespace {

TEST(Published, TotalsFollowTheFormula) {
  for (const PublishedVolume& row : kPublished) {
    EXPECT_LT(row.error(), 0.002) << row.volume << ": printed " << row.total_ms << ", computed "
                                  << row.computed_ms();
    EXPECT_GT(row.computed_ms(), 0) << row.volume;
  }
}

TEST(Published, DetectsAWrongTotal) {
  PublishedVolume row = kPublished[0];
  row.total_ms *= 1.01;
  EXPECT_NEAR(row.error(), 0.01, 0.0002);
}

TEST(Published, CountsAllPairsOf15In499Frames) {
  for (const PublishedVolume& row : kPublished) {
    EXPECT_EQ(row.tests, 15u * 14u / 2u * 499u) << row.volume;
    EXPECT_EQ(row.updates, 2 * row.tests) << row.volume;
  }
}

TEST(Published, HasARowForEveryVolume) {
  for (const std::string_view name : kMethods)
    EXPECT_EQ(published_for(name) == nullptr, name == "exact") << name;
  EXPECT_EQ(published_for("kdop18_refit")->volume, "kdop");
  EXPECT_EQ(published_for("ordop26")->volume, "ordop");
}

TEST(Published, ReplacesALostDigit) {
  EXPECT_EQ(legible("872"), 872);
  EXPECT_EQ(legible("144?"), 1444.5);
  EXPECT_LT(legible("?"), 0);
}

}  // namespace
}  // namespace throng::paper::published_test
