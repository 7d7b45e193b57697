#include "avatars/gait/gait_curves.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "base/portable_math.h"

namespace throng {
namespace {

using Knot = PeriodicCurve::Knot;

// Relative speeds at which Boulic's tables change; the last one is their end.
constexpr double kSlow = 0.5;
constexpr double kFast = 1.3;
constexpr double kMaxRv = 3.0;

// This pelvis carries the trunk rigidly, Boulic's does not. His full roll would swing the head by 5
// cm to each side.
constexpr double kRollShare = 0.35;

// Forward surge of the body's centre, once per step, in leg lengths: 1 cm at 1.3 m/s and 1.9 steps
// per second, where the speed varies by 0.11 m/s.
constexpr double kSurge = 0.0125;
// Recorded heads surge by 0.6 to 0.7 cm. Boulic's pitch of 2 degrees would move a head on a trunk
// without joints more than the pelvis. Only his forward lean is kept.
constexpr double kPitchShare = 0.15;
// Fast walkers lean forward; otherwise their hips would reach the joint's limit.
constexpr double kFastLean_deg = 2.5;
// Phase of the highest speed: both feet carry, just after a heel strike.
constexpr double kSurgesFrom = 0.075;
double surge(double t) { return sin_cos(kTurn * 2 * (t - kSurgesFrom)).sin; }

double slow_share(double rv) { return std::min(rv / kSlow, 1.0); }

double fast_share(double rv) { return std::clamp((rv - kFast) / (kMaxRv - kFast), 0.0, 1.0); }

PeriodicCurve curve_of_degrees(std::vector<Knot> knots) {
  for (Knot& knot : knots) knot.value *= kDegree;
  return PeriodicCurve(knots);
}

// Knee flexion under load. Boulic's tables have 3 degrees up to RV 1.3 and 25 at RV 3; measured are
// 16.6 at 1.34 m/s (RV 1.56).
double loaded_knee_degrees(double rv) {
  constexpr double kMeasuredRv = 1.56;
  if (rv < kMeasuredRv) return 3 + (16.6 - 3) * rv / kMeasuredRv;
  return 16.6 + (25 - 16.6) * (rv - kMeasuredRv) / (kMaxRv - kMeasuredRv);
}

PeriodicCurve knee_curve(double rv) {
  const double s = fast_share(rv);
  return curve_of_degrees({{0.14 - 0.02 * s, loaded_knee_degrees(rv)},
                           {0.4, 3},
                           {0.75 - 0.05 * s, 3 + 67 * slow_share(rv) - 5 * s},
                           {1 - 0.03 * s, 3 + 3 * s}});
}

PeriodicCurve elbow_curve(double rv) {
  const double q = std::clamp((rv - kSlow) / (kFast - kSlow), 0.0, 1.0);
  const double a = slow_share(rv), s = fast_share(rv);
  return curve_of_degrees({{0.05, 3 + 3 * a + 8 * q - 6 * s},
                           {0.5 + 0.01 * q + 0.04 * s, 3 + 17 * a + 24 * q + 26 * s},
                           {0.9 - 0.1 * s, 3 + 5 * a + 9 * q - 6 * s}});
}

PeriodicCurve thorax_curve(double rv) {
  return curve_of_degrees(
      {{0.1, 4 * rv / 3}, {0.4, -1.5 * rv}, {0.6, -4 * rv / 3}, {0.9, 1.5 * rv}});
}

// Measured hip - knee + ankle: 19 degrees at heel strike, 0 from 0.1 to 0.35, -63 soon after
// toe-off, 0 again at 0.86, 21 at 0.95. It scales with the stride, sqrt(RV). The foot has no toe
// joint: rolling over its tip to 45 degrees lifts the ankle as much as rolling over the ball to 58.
PeriodicCurve foot_pitch_curve(double rv, GaitStyle style) {
  const double stride = parameters_of(style).stride * std::sqrt(rv);
  const double toe_off = stance_fraction(rv, style);
  return curve_of_degrees({{0, 16 * stride},
                           {0.09, 0},
                           {0.57 * toe_off, 0},
                           {toe_off, -36 * stride},
                           {toe_off + 0.05, -50 * stride},
                           {0.95, 17 * stride}});
}

}  // namespace

PeriodicCurve::PeriodicCurve(std::span<const Knot> knots) : count_(static_cast<int>(knots.size())) {
  assert(count_ >= 2 && count_ <= kMaxKnots);
  std::copy(knots.begin(), knots.end(), knots_.begin());
  const size_t n = knots.size();
  knots_[n] = {knots[0].t + 1, knots[0].value};
  for (size_t i = 0; i < n; ++i) {
    const Knot before = i > 0 ? knots_[i - 1] : Knot{knots_[n - 1].t - 1, knots_[n - 1].value};
    const double h0 = knots_[i].t - before.t, h1 = knots_[i + 1].t - knots_[i].t;
    assert(h0 > 0 && h1 > 0);
    const double s0 = (knots_[i].value - before.value) / h0;
    const double s1 = (knots_[i + 1].value - knots_[i].value) / h1;
    const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
    slopes_[i] = s0 * s1 > 0 ? (w0 + w1) / (w0 / s0 + w1 / s1) : 0;
  }
  slopes_[n] = slopes_[0];
}

double PeriodicCurve::operator()(double t) const {
  t -= std::floor(t - knots_[0].t);  // now in [first knot, first knot + 1)
  size_t i = 0;
  while (i + 1 < static_cast<size_t>(count_) && t >= knots_[i + 1].t) ++i;
  const double h = knots_[i + 1].t - knots_[i].t;
  const double u = (t - knots_[i].t) / h;
  const double v = 1 - u;
  return knots_[i].value * v * v * (1 + 2 * u) + slopes_[i] * h * u * v * v +
         knots_[i + 1].value * u * u * (1 + 2 * v) - slopes_[i + 1] * h * u * u * v;
}

double stance_fraction(double relative_speed, GaitStyle style) {
  // (0.752 T - 0.143 s) / T with T = 1.346 / sqrt(RV)
  return 0.752 - 0.143 / kStridePerSqrtSpeed * std::sqrt(relative_speed) +
         parameters_of(style).extra_stance;
}

double stride_per_sqrt_speed(GaitStyle style) {
  return parameters_of(style).stride * kStridePerSqrtSpeed;
}

GaitCurves::GaitCurves(double relative_speed, GaitStyle style)
    : relative_speed_(relative_speed),
      style_(&parameters_of(style)),
      knee_(knee_curve(relative_speed)),
      elbow_(elbow_curve(relative_speed)),
      thorax_(thorax_curve(relative_speed)),
      foot_pitch_(foot_pitch_curve(relative_speed, style)) {
  assert(relative_speed >= 0 && relative_speed <= kMaxRv + 1e-9);
}

double GaitCurves::elbow_flexion(double t) const {
  return style_->arm_swing * elbow_(t) + style_->elbow_bent_deg * kDegree;
}

double GaitCurves::shoulder_flexion(double t) const {
  const double amplitude = style_->arm_swing * 9.88 * relative_speed_;
  return (3 + style_->shoulder_ahead_deg - amplitude / 2 - amplitude * sin_cos(kTurn * t).cos) *
         kDegree;
}

double GaitCurves::pelvis_yaw(double t) const {
  return style_->twist * 4 * relative_speed_ * sin_cos(kTurn * t).cos * kDegree;
}

double GaitCurves::pelvis_pitch(double t) const {
  const double rv = std::min(relative_speed_, kSlow);
  const double amplitude = 8 * rv * (1 - rv);
  const double lean_deg =
      style_->lean_deg * slow_share(relative_speed_) + kFastLean_deg * fast_share(relative_speed_);
  return (amplitude - kPitchShare * amplitude * surge(t) + lean_deg) * kDegree;
}

double GaitCurves::pelvis_forward(double t) const {
  const double rv = std::min(relative_speed_, kSlow);
  const double quick = std::sqrt(std::max(relative_speed_ / kFast, 1.0));
  return kSurge * 4 * rv * (1 - rv) / quick * surge(t);
}

double GaitCurves::pelvis_roll(double t) const {
  // The hip of the swing leg drops within 0.15 of the cycle and returns by the next heel strike.
  t -= std::floor(t);
  const double half = t < 0.5 ? t : t - 0.5;
  const double drop = half < 0.15 ? 1 - sin_cos(kTurn * half / 0.3).cos
                                  : 1 + sin_cos(kTurn * (half - 0.15) / 0.7).cos;
  return (t < 0.5 ? -1 : 1) * style_->sway * kRollShare * 1.66 * relative_speed_ * drop * kDegree;
}

double GaitCurves::pelvis_lateral(double t) const {
  const double rv = std::min(relative_speed_, kSlow);
  return -style_->sway * 0.128 * rv * (1 - rv) * sin_cos(kTurn * (t - kSwayPhase)).sin;
}

}  // namespace throng
