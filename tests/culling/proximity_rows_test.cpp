// Proximity rows miss no pair within the margin and bound the distance, by family of bodies.
#include "tests/culling/proximity_rows.h"

#include <gtest/gtest.h>

namespace throng::test::proximity_rows_test {
namespace {

class ProximityByFamily : public ::testing::TestWithParam<bench::Family> {};

TEST_P(ProximityByFamily, MissesNothingAndBoundsTheDistance) {
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    const ProximityTally tally = check_proximity_rows(GetParam(), 1000, seed);
    EXPECT_EQ(tally.missed, 0u) << tally.first_wrong;
    EXPECT_EQ(tally.outside, 0u) << tally.first_wrong;
    EXPECT_EQ(tally.wide, 0u) << tally.first_wrong;
    EXPECT_EQ(tally.differing, 0u) << tally.first_wrong;
    EXPECT_GT(tally.by_all, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, ProximityByFamily, ::testing::ValuesIn(bench::kFamilies),
                         [](const auto& family) {
                           return std::string(bench::name_of(family.param));
                         });

}  // namespace
}  // namespace throng::test::proximity_rows_test
