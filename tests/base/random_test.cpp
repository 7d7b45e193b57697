// Random numbers are functions of their keys, with the stated distributions and independent
// streams.
#include "base/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace throng::random_test {
namespace {

constexpr int kDraws = 100'000;

RandomKey key_of(int i) { return {.seed = 7, .id = static_cast<uint64_t>(i)}; }

TEST(Random, GivesTheSameBitsForAKeyInEveryVersion) {
  // From an independent implementation of the published formula. A change of these numbers changes
  // every published hash.
  EXPECT_EQ(random_bits({}), 0xe80daf3f3371cf67ull);
  EXPECT_EQ(random_bits({.seed = 1, .id = 2, .step = 3, .purpose = Purpose::kGoal}, 4),
            0xb086e02eb80188acull);
}

TEST(Random, DependsOnEveryFieldOfTheKey) {
  const RandomKey base{.seed = 1, .id = 1, .step = 1, .purpose = Purpose::kHeight};
  std::set<uint64_t> seen = {random_bits(base), random_bits(base, 1)};
  RandomKey other = base;
  other.seed = 2;
  seen.insert(random_bits(other));
  other = base;
  other.id = 2;
  seen.insert(random_bits(other));
  other = base;
  other.step = 2;
  seen.insert(random_bits(other));
  other = base;
  other.purpose = Purpose::kGoal;
  seen.insert(random_bits(other));
  EXPECT_EQ(seen.size(), 6u);
}

TEST(Random, FillsItsIntervalUniformly) {
  std::array<int, 10> bins{};
  for (int i = 0; i < kDraws; ++i) {
    const double value = random_uniform(key_of(i), -2, 3);
    ASSERT_GE(value, -2) << "id " << i;
    ASSERT_LT(value, 3) << "id " << i;
    ++bins[static_cast<size_t>((value + 2) * 2)];
  }
  // A bin holds 10 000 +- 95; seven standard deviations never happen by chance.
  for (const int bin : bins) EXPECT_NEAR(bin, kDraws / 10.0, 7 * 95);
}

TEST(Random, IsUncorrelatedBetweenNeighbouringIds) {
  double sum = 0;
  for (int i = 0; i < kDraws; ++i)
    sum += (random_uniform(key_of(i)) - 0.5) * (random_uniform(key_of(i + 1)) - 0.5);
  // The product of two centred uniforms has standard deviation 1/12.
  EXPECT_NEAR(sum / kDraws, 0, 7.0 / 12 / std::sqrt(kDraws));
}

TEST(Random, HasNormalMeanDeviationAndShape) {
  double sum = 0;
  double squares = 0;
  int within_one = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random_normal(key_of(i), 1.34, 0.26);
    ASSERT_TRUE(std::isfinite(value)) << "id " << i;
    sum += value;
    squares += (value - 1.34) * (value - 1.34);
    within_one += std::abs(value - 1.34) < 0.26 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kDraws, 1.34, 7 * 0.26 / std::sqrt(kDraws));
  EXPECT_NEAR(std::sqrt(squares / kDraws), 0.26, 7 * 0.26 / std::sqrt(2.0 * kDraws));
  EXPECT_NEAR(within_one / static_cast<double>(kDraws), 0.6827, 7 * 0.00147);
}

}  // namespace
}  // namespace throng::random_test
