#include "scenes/trig.h"

#include <cmath>
#include <numbers>

namespace throng {

SinCos sin_cos(double angle_rad) {
  // Reduced to [-pi/4, pi/4], where ten terms of the Taylor series leave less than one ulp.
  const double quarters = std::floor(angle_rad / (std::numbers::pi / 2) + 0.5);
  const double x = angle_rad - quarters * (std::numbers::pi / 2);
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

}  // namespace throng
