// The published curves: periodic, within their knots, continuous where the tables change.
#include "avatars/gait/gait_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "base/portable_math.h"

namespace throng::gait_curves_test {
namespace {

using Knots = std::vector<PeriodicCurve::Knot>;

TEST(PeriodicCurve, PassesThroughItsKnotsInEveryCycle) {
  const Knots knots = {{-0.1, 25}, {0.3, 4}, {0.5, -15}, {0.8, 7}};
  const PeriodicCurve curve(knots);
  for (const PeriodicCurve::Knot& knot : knots)
    for (const double cycle : {-2.0, 0.0, 1.0, 5.0})
      EXPECT_NEAR(curve(knot.t + cycle), knot.value, 1e-9) << "t = " << knot.t + cycle;
}

TEST(PeriodicCurve, IsMonotoneBetweenKnots) {
  const Knots knots = {{0.05, 1}, {0.1, 30}, {0.5, 31}, {0.52, -20}, {0.97, -19.5}};
  const PeriodicCurve curve(knots);
  for (size_t k = 0; k < knots.size(); ++k) {
    const PeriodicCurve::Knot from = knots[k];
    PeriodicCurve::Knot to = knots[(k + 1) % knots.size()];
    if (to.t < from.t) to.t += 1;
    const double rising = to.value > from.value ? 1 : -1;
    double before = from.value;
    for (int i = 1; i <= 200; ++i) {
      const double value = curve(from.t + (to.t - from.t) * i / 200);
      ASSERT_GE(rising * (value - before), -1e-12)
          << "between knots " << k << " and the next, " << i;
      before = value;
    }
  }
}

TEST(PeriodicCurve, HasOneSlopeOnBothSidesOfAKnot) {
  const PeriodicCurve curve(Knots{{0, 0}, {0.2, 3}, {0.5, 20}, {0.7, 4}});
  const double h = 1e-6;
  for (const double t : {0.0, 0.2, 0.5, 0.7}) {
    const double left = (curve(t) - curve(t - h)) / h, right = (curve(t + h) - curve(t)) / h;
    EXPECT_NEAR(left, right, 0.01) << "at " << t;
  }
}

struct NamedCurve {
  const char* name;
  std::function<double(const GaitCurves&, double)> value;
};

const std::vector<NamedCurve>& all_curves() {
  static const std::vector<NamedCurve> curves = {
      {"knee", [](const GaitCurves& g, double t) { return g.knee_flexion(t); }},
      {"elbow", [](const GaitCurves& g, double t) { return g.elbow_flexion(t); }},
      {"shoulder", [](const GaitCurves& g, double t) { return g.shoulder_flexion(t); }},
      {"foot pitch", [](const GaitCurves& g, double t) { return g.foot_pitch(t); }},
      {"pelvis yaw", [](const GaitCurves& g, double t) { return g.pelvis_yaw(t); }},
      {"pelvis pitch", [](const GaitCurves& g, double t) { return g.pelvis_pitch(t); }},
      {"pelvis roll", [](const GaitCurves& g, double t) { return g.pelvis_roll(t); }},
      {"pelvis lateral", [](const GaitCurves& g, double t) { return g.pelvis_lateral(t); }},
      {"pelvis forward", [](const GaitCurves& g, double t) { return g.pelvis_forward(t); }},
      {"thorax yaw", [](const GaitCurves& g, double t) { return g.thorax_yaw(t); }},
  };
  return curves;
}

TEST(GaitCurves, AreContinuousWhereTheTablesChange) {
  for (const double rv : {0.5, 1.3, 1.56}) {
    const GaitCurves below(rv - 1e-7), above(rv + 1e-7);
    for (const NamedCurve& curve : all_curves())
      for (int i = 0; i < 500; ++i) {
        const double t = i / 500.0;
        ASSERT_NEAR(curve.value(below, t), curve.value(above, t), 1e-5)
            << curve.name << " at RV " << rv << ", t " << t;
      }
  }
}

TEST(GaitCurves, RepeatEachCycle) {
  for (const double rv : {0.1, 0.7, 1.56, 2.9}) {
    const GaitCurves curves(rv);
    for (const NamedCurve& curve : all_curves())
      for (const double t : {0.0, 0.21, 0.5, 0.77})
        EXPECT_NEAR(curve.value(curves, t), curve.value(curves, t + 1), 1e-9) << curve.name;
  }
}

TEST(GaitCurves, MatchThePublishedValues) {
  // RV 0.3: the row below 0.5. RV 0.9: the middle one. RV 3: s = 1. The lowest row's knee peak is
  // 140 RV; here 3 + 134 RV, because a knee at rest is at 3 degrees.
  EXPECT_NEAR(GaitCurves(0.3).knee_flexion(0.75), (3 + 134 * 0.3) * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(0.9).knee_flexion(0.75), 70 * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(3.0).knee_flexion(0.70), 65 * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(3.0).knee_flexion(0.12), 25 * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(0.3).elbow_flexion(0.5), (34 * 0.3 + 3) * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(0.9).elbow_flexion(0.505), (20 + 24 * 0.5) * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(3.0).elbow_flexion(0.55), 70 * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(1.0).shoulder_flexion(0.5), (3 + 9.88 / 2) * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(1.0).pelvis_yaw(0), 4 * kDegree, 1e-9);
  EXPECT_NEAR(GaitCurves(1.0).pelvis_lateral(0.35), -0.032, 1e-9);
  EXPECT_NEAR(GaitCurves(0.25).pelvis_lateral(0.35), -0.128 * 0.25 * 0.75, 1e-9);
}

TEST(GaitCurves, SpendSixTenthsOfABriskCycleOnOneFoot) {
  // 1.34 m/s with a leg of 0.859 m: T = 1.078 s, support 0.668 s.
  EXPECT_NEAR(stance_fraction(1.56), 0.619, 0.001);
  for (int i = 0; i <= 300; ++i) {
    const double rv = i / 100.0;
    ASSERT_GT(stance_fraction(rv), 0.5) << "walking has no flight phase, RV " << rv;
    ASSERT_LT(stance_fraction(rv), 0.76);
  }
}

TEST(GaitCurves, MirrorTheSidesHalfACycleApart) {
  const GaitCurves curves(1.56);
  for (int i = 0; i < 100; ++i) {
    const double t = i / 100.0;
    EXPECT_NEAR(curves.pelvis_yaw(t), -curves.pelvis_yaw(t + 0.5), 1e-9);
    EXPECT_NEAR(curves.pelvis_roll(t), -curves.pelvis_roll(t + 0.5), 1e-9);
    EXPECT_NEAR(curves.pelvis_lateral(t), -curves.pelvis_lateral(t + 0.5), 1e-9);
    EXPECT_NEAR(curves.thorax_yaw(t), -curves.thorax_yaw(t + 0.5), 1e-9);
    EXPECT_NEAR(curves.pelvis_pitch(t), curves.pelvis_pitch(t + 0.5), 1e-9);
    EXPECT_NEAR(curves.pelvis_forward(t), curves.pelvis_forward(t + 0.5), 1e-9);
  }
}

TEST(GaitCurves, MatchTheMeasuredFootPitch) {
  // Measured (1.34 m/s): 19 degrees at heel strike, 0 in mid-stance.
  const GaitCurves curves(1.56);
  EXPECT_NEAR(curves.foot_pitch(0) / kDegree, 19, 2);
  EXPECT_NEAR(curves.foot_pitch(0.95) / kDegree, 21.5, 2);
  EXPECT_NEAR(curves.foot_pitch(0.8) / kDegree, -24, 4);
  for (int i = 10; i < 34; ++i) EXPECT_EQ(curves.foot_pitch(i / 100.0), 0) << i;
}

}  // namespace
}  // namespace throng::gait_curves_test
