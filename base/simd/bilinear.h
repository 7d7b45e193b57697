// Between four rows of a table.
// One rule: store_bilinear() of base/simd/lanes-inl.h does the same to each lane, operation for
// operation.
#pragma once

#include <cstddef>

namespace throng {

/// Between *from and the float `next` farther on by u, and the same two `step` farther on by v.
inline float bilinear(const float* from, size_t next, size_t step, float u, float v) {
  const float slow = from[0] + u * (from[next] - from[0]);
  const float fast = from[step] + u * (from[step + next] - from[step]);
  return slow + v * (fast - slow);
}

}  // namespace throng
