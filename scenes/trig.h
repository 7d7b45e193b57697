// Sine and cosine that are the same to the bit on every machine.
// One rule: only +, -, * and /, which IEEE 754 rounds alike everywhere; the C library's own
// versions pick another code path on another processor.
#pragma once

namespace throng {

struct SinCos {
  double sin = 0;
  double cos = 1;
};

/// |angle_rad| up to a few turns; absolute error below 1e-15 times the number of turns.
SinCos sin_cos(double angle_rad);

}  // namespace throng
