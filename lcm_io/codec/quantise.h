// Quantisation of real numbers to integers, and back.
// Invariant: the error is at most half a step, and a value out of range is clamped and counted,
// never wrapped.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace throng {

/// Rounds half away from zero. NaN becomes 0, and values beyond +-limit become +-limit; both are
/// counted.
inline int32_t quantised(double value, double limit, int32_t& clamped) {
  if (!(std::abs(value) < limit + 0.5)) {
    ++clamped;
    if (std::isnan(value)) return 0;
    value = value > 0 ? limit : -limit;
  }
  return static_cast<int32_t>(value + (value >= 0 ? 0.5 : -0.5));
}

/// Positions: steps of 0.1 mm, error 0.05 mm per axis, up to 214 km from the origin.
inline constexpr double kPositionStep_m = 1e-4;
inline constexpr double kPositionStepsPerMetre = 1e4;
inline int32_t quantised_position(double metres, int32_t& clamped) {
  return quantised(metres * kPositionStepsPerMetre, 2147483646.0, clamped);
}
inline double position_of(int32_t q) { return q * kPositionStep_m; }

/// Unit quaternions: steps of 1/32767 per component. The four half-step errors have a norm of at
/// most 3.1e-5; the angle error is twice that: 6.2e-5 rad, or 0.06 mm at 1 m.
inline constexpr double kUnitSteps = 32767;
inline int16_t quantised_unit(float component, int32_t& clamped) {
  return static_cast<int16_t>(
      quantised(static_cast<double>(component) * kUnitSteps, kUnitSteps, clamped));
}
inline Eigen::Quaternionf rotation_of(int16_t w, int16_t x, int16_t y, int16_t z) {
  const Eigen::Quaternionf q(w, x, y, z);
  return q.squaredNorm() > 0 ? q.normalized() : Eigen::Quaternionf::Identity();
}

/// Range that an int16 posture column covers: the joint's limits. Error: half / 65534, for a knee
/// of 2.5 rad 1.9e-5 rad.
struct ColumnRange {
  double middle = 0;
  double half = 0;
  bool wraps = false;  ///< continuous angle, brought into -pi .. pi first

  int16_t quantised_value(float value, int32_t& clamped) const {
    if (half == 0) return 0;
    double v = static_cast<double>(value);
    if (wraps) v -= 2 * std::numbers::pi * std::floor(v / (2 * std::numbers::pi) + 0.5);
    return static_cast<int16_t>(quantised((v - middle) / half * kUnitSteps, kUnitSteps, clamped));
  }
  float value_of(int16_t q) const { return static_cast<float>(middle + half * q / kUnitSteps); }
};

}  // namespace throng
