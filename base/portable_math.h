// Elementary functions that are bitwise equal on every machine.
// Invariant: only +, -, *, / and the square root, which IEEE 754 rounds alike everywhere. The C
// library picks different code paths on different processors.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace throng {

/// A full turn in radians.
inline constexpr double kTurn = 2 * std::numbers::pi;
inline constexpr double kDegree = std::numbers::pi / 180;

/// Fraction of the last of `cycles` cycles, in [0, 1), never rounded to 1; NaN stays NaN.
inline float phase_of(double cycles) {
  const auto phase = static_cast<float>(cycles - std::floor(cycles));
  return phase >= 1 ? 0 : phase;
}
inline float phase_of(float cycles) { return phase_of(static_cast<double>(cycles)); }

struct SinCos {
  double sin = 0;
  double cos = 1;
};

/// |angle_rad| up to a few turns; absolute error below 1e-15 times the number of turns.
SinCos sin_cos(double angle_rad);
/// A float caller chooses: sin_cos() in double, or float_sin_cos().
SinCos sin_cos(float angle_rad) = delete;

struct FloatSinCos {
  float sin = 0;
  float cos = 1;
};

/// Constants of float_sin_cos(). The angle q is reduced by the nearest multiple n of pi:
/// r = q - n pi in [-pi/2, pi/2], sin q = (-1)^n sin r, cos q = (-1)^n cos r. The polynomials are
/// minimax in absolute error (Remez): 4.7e-9 for the sine, 2.5e-10 for the cosine; the rest is
/// rounding.
struct FloatSinCosConstants {
  static constexpr float kOneOverPi = 0.31830987334251404f;
  /// Adding 1.5 * 2^23 rounds to the nearest integer and leaves its parity in the lowest bit.
  static constexpr float kRound = 12582912.0f;
  /// pi in two parts: n * kPiHigh is exact for |n| < 2^14, the sum is off by 5e-12.
  static constexpr float kPiHigh = 3.140625f;
  static constexpr float kPiLow = 0.0009676535846665502f;
  static constexpr float kSin[4] = {-0.16666656732559204f, 0.008333016186952591f,
                                    -0.00019806547788903117f, 2.5999031549872598e-06f};
  static constexpr float kCos[5] = {-0.5f, 0.04166664183139801f, -0.0013888402609154582f,
                                    2.476180816302076e-05f, -2.6075662162838853e-07f};
};

/// Constants of float_arc_tan2(): t P(t^2) on [0, 1], minimax for the arc tangent, error below
/// 2e-6. The longer coordinate and the signs choose the octant.
struct FloatArcTanConstants {
  static constexpr float kP[6] = {0.99997726f,  -0.33262347f, 0.19354346f,
                                  -0.11643287f, 0.05265332f,  -0.01172120f};
  static constexpr float kHalfPi = 1.57079633f;
  static constexpr float kPi = 3.14159265f;
};

/// Angle in [-pi, pi], error below 4e-6; 0 for the origin. angles_of() in base/simd/angles-inl.h
/// does the same to lanes.
inline float float_arc_tan2(float y, float x) {
  using K = FloatArcTanConstants;
  const float ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const float longer = ax > ay ? ax : ay, shorter = ax > ay ? ay : ax;
  const float t = longer > 0 ? shorter / longer : 0, s = t * t;
  float angle = K::kP[5];
  for (int power = 4; power >= 0; --power) angle = angle * s + K::kP[power];
  angle *= t;
  if (ay > ax) angle = K::kHalfPi - angle;
  if (x < 0) angle = K::kPi - angle;
  return y < 0 ? -angle : angle;
}

/// Error below 2e-7 for |angle_rad| <= 100; finite but useless far beyond 10^4. float_sin_cos() in
/// base/simd/lanes-inl.h does the same to each lane, operation for operation.
inline FloatSinCos float_sin_cos(float angle_rad) {
  using K = FloatSinCosConstants;
  const float rounded = angle_rad * K::kOneOverPi + K::kRound;
  const float n = rounded - K::kRound;
  const uint32_t sign = std::bit_cast<uint32_t>(rounded) << 31;
  const float r = (angle_rad - n * K::kPiHigh) - n * K::kPiLow;
  const float z = r * r;
  float s = K::kSin[3];
  s = s * z + K::kSin[2];
  s = s * z + K::kSin[1];
  s = s * z + K::kSin[0];
  s = r + (r * z) * s;
  float c = K::kCos[4];
  c = c * z + K::kCos[3];
  c = c * z + K::kCos[2];
  c = c * z + K::kCos[1];
  c = c * z + K::kCos[0];
  c = 1.0f + z * c;
  return {std::bit_cast<float>(std::bit_cast<uint32_t>(s) ^ sign),
          std::bit_cast<float>(std::bit_cast<uint32_t>(c) ^ sign)};
}

/// Position of the minimum of the parabola through three equidistant values, the middle one least,
/// in steps within [-1/2, 1/2]; 0 if the second difference is at most `min_bend`.
inline float parabola_minimum(float before, float here, float after, float min_bend = 0) {
  const float bend = before - 2 * here + after;
  if (!(bend > min_bend)) return 0;
  const float step = 0.5f * (before - after) / bend;
  return step < -0.5f ? -0.5f : (step > 0.5f ? 0.5f : step);
}

/// Angle of (x, y) in (-pi, pi], absolute error below 1e-15; 0 for the origin.
double arc_tan2(double y, double x);
/// For values in [-1, 1].
double arc_sin(double value);
double arc_cos(double value);

/// Length of (x, y), for coordinates whose squares neither overflow nor vanish.
double length_of(double x, double y);

/// For normal numbers above 0; relative error below 1e-15, next to 1 absolute error.
double natural_log(double value);
/// For normal numbers above 0; relative error below 1e-15.
double cube_root(double value);

/// Rotation by angle_rad about a unit axis (Rodrigues).
Eigen::Matrix3d turn_about(const Eigen::Vector3d& axis, double angle_rad);

}  // namespace throng
