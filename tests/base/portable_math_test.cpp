// The portable functions agree with the C library, which is accurate but differs between machines.
#include "base/portable_math.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"

namespace throng::portable_math_test {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(PortableMath, AgreesWithTheCLibraryOnSineAndCosine) {
  for (int i = 0; i < 1898; ++i) {
    const double angle = -13 + 0.0137 * i;
    const SinCos found = sin_cos(angle);
    ASSERT_NEAR(found.sin, std::sin(angle), 4e-15) << "at " << angle;
    ASSERT_NEAR(found.cos, std::cos(angle), 4e-15) << "at " << angle;
  }
}

TEST(PortableMath, AgreesOnArcTangentInEveryQuadrant) {
  for (uint64_t i = 0; i < 20'000; ++i) {
    const RandomKey key{.seed = 3, .id = i};
    // Slopes from 1e-9 to 1e9.
    const double x = random_uniform(key, -1, 1, 0) * std::pow(10, random_uniform(key, -9, 0, 1));
    const double y = random_uniform(key, -1, 1, 2) * std::pow(10, random_uniform(key, -9, 0, 3));
    ASSERT_NEAR(arc_tan2(y, x), std::atan2(y, x), 1e-15) << y << ", " << x;
  }
}

TEST(PortableMath, IsExactOnTheAxes) {
  EXPECT_EQ(arc_tan2(0, 0), 0);
  EXPECT_EQ(arc_tan2(0, 2), 0);
  EXPECT_EQ(arc_tan2(3, 0), kPi / 2);
  EXPECT_EQ(arc_tan2(-3, 0), -kPi / 2);
  EXPECT_EQ(arc_tan2(0, -2), kPi);
}

TEST(PortableMath, AgreesOnArcSineAndCosineToTheirEnds) {
  for (int i = -10'000; i <= 10'000; ++i) {
    const double value = i / 10'000.0;
    ASSERT_NEAR(arc_sin(value), std::asin(value), 1e-15) << value;
    ASSERT_NEAR(arc_cos(value), std::acos(value), 1e-15) << value;
  }
}

TEST(PortableMath, AgreesOnLogarithmAndCubeRootOverAllScales) {
  for (uint64_t i = 0; i < 20'000; ++i) {
    const RandomKey key{.seed = 4, .id = i};
    const double value = std::pow(10, random_uniform(key, -300, 300));
    ASSERT_NEAR(natural_log(value), std::log(value), 1e-15 * std::abs(std::log(value))) << value;
    ASSERT_NEAR(cube_root(value), std::cbrt(value), 1e-15 * std::cbrt(value)) << value;
    const double near_one = 1 - random_uniform(key, 0, 0.01, 1);
    ASSERT_NEAR(natural_log(near_one), std::log(near_one), 1e-15) << near_one;
  }
  EXPECT_EQ(natural_log(1), 0);
  EXPECT_EQ(cube_root(27), 3);
}

TEST(PortableMath, AgreesOnRotations) {
  for (uint64_t i = 0; i < 1000; ++i) {
    const RandomKey key{.seed = 5, .id = i};
    const Eigen::Vector3d axis =
        Eigen::Vector3d(random_uniform(key, -1, 1, 0), random_uniform(key, -1, 1, 1),
                        random_uniform(key, -1, 1, 2))
            .normalized();
    const double angle = random_uniform(key, -7, 7, 3);
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    ASSERT_LT((turn_about(axis, angle) - expected).cwiseAbs().maxCoeff(), 4e-15) << i;
  }
}

double worst_error(double limit_rad, int samples) {
  double worst = 0;
  for (int i = -samples; i <= samples; ++i) {
    const float angle = static_cast<float>(limit_rad * i / samples);
    const FloatSinCos found = float_sin_cos(angle);
    worst = std::max(
        {worst, std::abs(static_cast<double>(found.sin) - std::sin(static_cast<double>(angle))),
         std::abs(static_cast<double>(found.cos) - std::cos(static_cast<double>(angle)))});
  }
  return worst;
}

TEST(FloatSinCos, ErrsByLessThan2e7WithinATurn) {
  EXPECT_LT(worst_error(2 * std::numbers::pi, 500000), 2e-7);
}

TEST(FloatSinCos, ErrsByLessThan2e7WithinSixteenTurns) {
  EXPECT_LT(worst_error(100, 500000), 2e-7);
}

TEST(FloatSinCos, ErrsByLessThan2e7NearQuarterTurns) {
  for (int quarter = -40; quarter <= 40; ++quarter) {
    float angle = static_cast<float>(quarter * std::numbers::pi / 2);
    for (int i = 0; i < 50; ++i) angle = std::nextafterf(angle, -1000.0f);
    for (int i = 0; i < 100; ++i, angle = std::nextafterf(angle, 1000.0f)) {
      const FloatSinCos found = float_sin_cos(angle);
      ASSERT_NEAR(static_cast<double>(found.sin), std::sin(static_cast<double>(angle)), 2e-7)
          << angle;
      ASSERT_NEAR(static_cast<double>(found.cos), std::cos(static_cast<double>(angle)), 2e-7)
          << angle;
    }
  }
}

TEST(FloatSinCos, IsExactlySymmetric) {
  EXPECT_EQ(float_sin_cos(0.0f).sin, 0.0f);
  EXPECT_EQ(float_sin_cos(0.0f).cos, 1.0f);
  for (int i = 0; i < 1000; ++i) {
    const float angle = 0.01f * static_cast<float>(i);
    EXPECT_EQ(float_sin_cos(-angle).sin, -float_sin_cos(angle).sin);
    EXPECT_EQ(float_sin_cos(-angle).cos, float_sin_cos(angle).cos);
  }
}

TEST(FloatArcTan2, ErrsByLessThanFourMillionths) {
  for (int i = 0; i < 100'000; ++i) {
    const double angle = -std::numbers::pi + i * (2 * std::numbers::pi / 100'000);
    for (const double far : {1e-3, 1.0, 1e3}) {
      const auto y = static_cast<float>(far * std::sin(angle)),
                 x = static_cast<float>(far * std::cos(angle));
      ASSERT_NEAR(float_arc_tan2(y, x), std::atan2(y, x), 4e-6) << angle;
    }
  }
  EXPECT_EQ(float_arc_tan2(0, 0), 0.0f);
}

TEST(PhaseOf, StaysBelowOneAfterRounding) {
  EXPECT_EQ(phase_of(0.25f), 0.25f);
  EXPECT_EQ(phase_of(3.75), 0.75f);
  EXPECT_EQ(phase_of(-0.25f), 0.75f);
  EXPECT_EQ(phase_of(1.0f), 0.0f);
  for (const double hardly_less : {0.99999999, -1e-12, 7 - 1e-9})
    EXPECT_EQ(phase_of(hardly_less), 0);
  EXPECT_TRUE(std::isnan(phase_of(std::nan(""))));
}

}  // namespace
}  // namespace throng::portable_math_test
