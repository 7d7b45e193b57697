#include "base/portable_math.h"

#include <cmath>
#include <numbers>

namespace throng {
namespace {

constexpr double kPi = std::numbers::pi;

/// Arc tangent of a ratio from 0 to 1.
double arc_tan(double ratio) {
  // Halves the angle twice: for at most tan(pi/16) twelve terms leave 1e-18.
  for (int halving = 0; halving < 2; ++halving) ratio /= 1 + std::sqrt(1 + ratio * ratio);
  const double square = ratio * ratio;
  double sum = 0;
  for (int k = 23; k >= 1; k -= 2) sum = 1.0 / k - square * sum;
  return 4 * ratio * sum;
}

}  // namespace

SinCos sin_cos(double angle_rad) {
  // Reduced to [-pi/4, pi/4], where ten terms of the Taylor series leave less than one ulp.
  const double quarters = std::floor(angle_rad / (kPi / 2) + 0.5);
  const double x = angle_rad - quarters * (kPi / 2);
  const double square = x * x;
  double sine = 0;
  double cosine = 0;
  for (int k = 20; k >= 2; k -= 2) {
    cosine = (1 + cosine) * -square / (k * (k - 1.0));
    sine = (1 + sine) * -square / (k * (k + 1.0));
  }
  sine = x * (1 + sine);
  cosine = 1 + cosine;
  switch (static_cast<int>(quarters) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

double arc_tan2(double y, double x) {
  const double height = std::abs(y);
  const double width = std::abs(x);
  if (height == 0 && width == 0) return 0;
  const double acute =
      height <= width ? arc_tan(height / width) : kPi / 2 - arc_tan(width / height);
  return std::copysign(x < 0 ? kPi - acute : acute, y);
}

double arc_sin(double value) { return arc_tan2(value, std::sqrt((1 - value) * (1 + value))); }

double arc_cos(double value) { return arc_tan2(std::sqrt((1 - value) * (1 + value)), value); }

double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

double natural_log(double value) {
  int exponent = 0;
  double mantissa = std::frexp(value, &exponent);
  if (mantissa < 0.5 * std::numbers::sqrt2) {
    mantissa *= 2;
    --exponent;
  }
  // log m = 2 artanh((m - 1) / (m + 1)), at most 0.172: eleven terms leave 1e-18.
  const double ratio = (mantissa - 1) / (mantissa + 1);
  const double square = ratio * ratio;
  double sum = 0;
  for (int k = 21; k >= 1; k -= 2) sum = 1.0 / k + square * sum;
  return 2 * ratio * sum + exponent * std::numbers::ln2;
}

double cube_root(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  double root = std::ldexp(1, (exponent + 3000) / 3 - 1000);
  // Newton from within a factor of two of the root doubles the digits each time.
  for (int round = 0; round < 8; ++round) root = (2 * root + value / (root * root)) / 3;
  return root;
}

Eigen::Matrix3d turn_about(const Eigen::Vector3d& axis, double angle_rad) {
  const SinCos turn = sin_cos(angle_rad);
  const Eigen::Vector3d sines = turn.sin * axis;
  const Eigen::Vector3d rest = (1 - turn.cos) * axis;
  const double xy = rest.x() * axis.y();
  const double xz = rest.x() * axis.z();
  const double yz = rest.y() * axis.z();
  Eigen::Matrix3d out;
  out << rest.x() * axis.x() + turn.cos, xy - sines.z(), xz + sines.y(),  //
      xy + sines.z(), rest.y() * axis.y() + turn.cos, yz - sines.x(),     //
      xz - sines.y(), yz + sines.x(), rest.z() * axis.z() + turn.cos;
  return out;
}

}  // namespace throng
