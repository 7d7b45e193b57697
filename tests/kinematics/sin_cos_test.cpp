// Our float sine and cosine against the C library's in double.
#include "kinematics/sin_cos.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace throng {
namespace {

double worst_error(double limit_rad, int samples) {
  double worst = 0;
  for (int i = -samples; i <= samples; ++i) {
    const float angle = static_cast<float>(limit_rad * i / samples);
    const SinCosFloat found = sin_cos(angle);
    worst = std::max(
        {worst, std::abs(static_cast<double>(found.sin) - std::sin(static_cast<double>(angle))),
         std::abs(static_cast<double>(found.cos) - std::cos(static_cast<double>(angle)))});
  }
  return worst;
}

TEST(SinCos, is_off_by_less_than_2e_7_within_a_turn) {
  EXPECT_LT(worst_error(2 * std::numbers::pi, 500000), 2e-7);
}

TEST(SinCos, is_off_by_less_than_2e_7_within_sixteen_turns) {
  EXPECT_LT(worst_error(100, 500000), 2e-7);
}

TEST(SinCos, is_off_by_less_than_2e_7_at_the_quarters_and_their_neighbours) {
  for (int quarter = -40; quarter <= 40; ++quarter) {
    float angle = static_cast<float>(quarter * std::numbers::pi / 2);
    for (int i = 0; i < 50; ++i) angle = std::nextafterf(angle, -1000.0f);
    for (int i = 0; i < 100; ++i, angle = std::nextafterf(angle, 1000.0f)) {
      const SinCosFloat found = sin_cos(angle);
      ASSERT_NEAR(static_cast<double>(found.sin), std::sin(static_cast<double>(angle)), 2e-7)
          << angle;
      ASSERT_NEAR(static_cast<double>(found.cos), std::cos(static_cast<double>(angle)), 2e-7)
          << angle;
    }
  }
}

TEST(SinCos, keeps_the_symmetries_to_the_bit) {
  EXPECT_EQ(sin_cos(0.0f).sin, 0.0f);
  EXPECT_EQ(sin_cos(0.0f).cos, 1.0f);
  for (float angle = 0; angle < 10; angle += 0.01f) {
    EXPECT_EQ(sin_cos(-angle).sin, -sin_cos(angle).sin);
    EXPECT_EQ(sin_cos(-angle).cos, sin_cos(angle).cos);
  }
}

}  // namespace
}  // namespace throng
