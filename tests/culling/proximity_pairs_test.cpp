// No misses, over the whole pass and the odd cases. The long form: build/release/no_miss 10000000.
#include "tests/culling/proximity_pairs.h"

#include <gtest/gtest.h>

namespace throng::test::proximity_pairs_test {
namespace {

class NearPairsLaw : public testing::TestWithParam<Family> {};

TEST_P(NearPairsLaw, WhatTouchesIsReportedAsByTheReference) {
  const ProximityPairs found = check_proximity_pairs(GetParam(), 20'000, 20265);
  EXPECT_EQ(found.missed, 0u) << found.first_miss;
  // Otherwise the law was never put to the test.
  EXPECT_GT(found.touching, found.tested / 100);
  // Boxes on a lattice touch where they are near.
  if (GetParam() != Family::kTouching) {
    EXPECT_LT(found.touching, found.tested);
  }
  EXPECT_GE(found.reported, found.touching);
  EXPECT_EQ(found.differing, 0u) << found.first_difference;
}

TEST_P(NearPairsLaw, HoldsForEveryMixtureOfVolumes) {
  const ProximityPairs found = check_mixtures(GetParam(), 10, 20267);
  EXPECT_EQ(found.missed, 0u) << found.first_miss;
  EXPECT_EQ(found.differing, 0u) << found.first_difference;
  if (GetParam() == Family::kMixed) return;  // triangles decide: held to one volume's answer
  EXPECT_GT(found.tested, 1000u);
  EXPECT_GT(found.touching, found.tested / 100);
}

INSTANTIATE_TEST_SUITE_P(Families, NearPairsLaw, testing::ValuesIn(kFamilies),
                         [](const auto& family) { return std::string(name_of(family.param)); });

}  // namespace
}  // namespace throng::test::proximity_pairs_test
