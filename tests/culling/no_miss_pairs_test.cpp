// The no-miss guarantee by family of bodies. Long form: build/release/no_miss 10000000.
#include "tests/culling/no_miss_pairs.h"

#include <gtest/gtest.h>

namespace throng::test::no_miss_pairs_test {
namespace {

class NoMissByFamily : public testing::TestWithParam<Family> {};

TEST_P(NoMissByFamily, ReportsEveryTouchingPairLikeTheReference) {
  const NoMissCounts found = check_no_misses(GetParam(), 20'000, 20265);
  EXPECT_EQ(found.missed, 0u) << found.first_miss;
  // Enough touching pairs for a meaningful test.
  EXPECT_GT(found.touching, found.tested / 100);
  // Near boxes on a lattice touch.
  if (GetParam() != Family::kTouching) {
    EXPECT_LT(found.touching, found.tested);
  }
  EXPECT_GE(found.reported, found.touching);
  EXPECT_EQ(found.differing, 0u) << found.first_difference;
}

TEST_P(NoMissByFamily, HoldsForEveryMixtureOfVolumes) {
  const NoMissCounts found = check_mixtures(GetParam(), 10, 20267);
  EXPECT_EQ(found.missed, 0u) << found.first_miss;
  EXPECT_EQ(found.differing, 0u) << found.first_difference;
  // triangles decide, so results equal those of one volume
  if (GetParam() == Family::kMixed) return;
  EXPECT_GT(found.tested, 1000u);
  EXPECT_GT(found.touching, found.tested / 100);
}

INSTANTIATE_TEST_SUITE_P(Families, NoMissByFamily, testing::ValuesIn(kFamilies),
                         [](const auto& family) { return std::string(name_of(family.param)); });

}  // namespace
}  // namespace throng::test::no_miss_pairs_test
