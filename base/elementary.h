// Elementary functions that are the same to the bit on every machine.
// One rule: only +, -, *, / and the square root, which IEEE 754 rounds alike everywhere; the C
// library's own versions pick another code path on another processor.
#pragma once

#include <Eigen/Core>

namespace throng {

struct SinCos {
  double sin = 0;
  double cos = 1;
};

/// |angle_rad| up to a few turns; absolute error below 1e-15 times the number of turns.
SinCos sin_cos(double angle_rad);

/// The angle of (x, y) in (-pi, pi], absolute error below 1e-15; 0 for the origin.
double arc_tan2(double y, double x);
/// Of values in [-1, 1].
double arc_sin(double value);
double arc_cos(double value);

/// The length of (x, y), for coordinates whose squares neither overflow nor vanish.
double length_of(double x, double y);

/// Of a normal number above 0, relative error below 1e-15 but next to 1, where it is absolute.
double natural_log(double value);
/// Of a normal number above 0, relative error below 1e-15.
double cube_root(double value);

/// Turns by angle_rad about a unit axis (Rodrigues).
Eigen::Matrix3d turn_about(const Eigen::Vector3d& axis, double angle_rad);

}  // namespace throng
