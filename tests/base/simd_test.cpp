// SIMD targets of this machine and their names.
#include "base/simd.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/errors.h"

namespace throng::simd_test {
namespace {

constexpr SimdTarget kAll[] = {SimdTarget::kBest, SimdTarget::kScalar, SimdTarget::kSse4,
                               SimdTarget::kAvx2, SimdTarget::kAvx512};

TEST(Simd, FindsATargetByItsName) {
  for (const SimdTarget target : kAll) EXPECT_EQ(simd_target_of(name_of(target)), target);
  EXPECT_EQ(simd_target_of("neon"), std::nullopt);
  EXPECT_EQ(simd_target_of(""), std::nullopt);
}

TEST(Simd, ListsTargetsFromScalarUpwardsWithoutBest) {
  const std::vector<SimdTarget> targets = simd_targets_of_this_machine();
  ASSERT_FALSE(targets.empty());
  EXPECT_EQ(targets.front(), SimdTarget::kScalar);
  EXPECT_TRUE(std::is_sorted(targets.begin(), targets.end()));
  EXPECT_THAT(targets, testing::Not(testing::Contains(SimdTarget::kBest)));
}

TEST(Simd, ResolvesATargetOrRejectsItByName) {
  const std::vector<SimdTarget> has = simd_targets_of_this_machine();
  EXPECT_EQ(resolved(SimdTarget::kBest), has.back());
  for (const SimdTarget target : kAll) {
    if (target == SimdTarget::kBest) continue;
    if (std::find(has.begin(), has.end(), target) != has.end()) {
      EXPECT_EQ(resolved(target), target) << name_of(target);
      continue;
    }
    try {
      resolved(target);
      ADD_FAILURE() << name_of(target) << " is not supported here and was accepted";
    } catch (const EnvironmentError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(std::string(name_of(target))));
    }
  }
}

}  // namespace
}  // namespace throng::simd_test
