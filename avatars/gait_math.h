// Angles from sides, the same bits on every machine.
// One rule: only +, -, *, / and square roots; see kinematics/sin_cos.h for the other direction.
#pragma once

#include <algorithm>
#include <cmath>

namespace throng {

/// Off by less than 2e-6; 0 for (0, 0).
inline float angle_of(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float longer = std::max(ax, ay);
  if (!(longer > 0)) return 0;
  const float t = std::min(ax, ay) / longer;
  const float s = t * t;
  // Minimax for the arc tangent on [0, 1].
  float angle = -0.01172120f;
  angle = angle * s + 0.05265332f;
  angle = angle * s - 0.11643287f;
  angle = angle * s + 0.19354346f;
  angle = angle * s - 0.33262347f;
  angle = (angle * s + 0.99997726f) * t;
  if (ay > ax) angle = 1.57079633f - angle;
  if (x < 0) angle = 3.14159265f - angle;
  return y < 0 ? -angle : angle;
}

/// The angle whose sine this is, clamped to [-1, 1].
inline float angle_of_sine(float sine) {
  const float s = std::clamp(sine, -1.0f, 1.0f);
  return angle_of(s, std::sqrt(1 - s * s));
}

}  // namespace throng
