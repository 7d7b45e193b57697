// blend_rows() interpolates rows between the nodes of a table, many at a time. Internal to the
// folder.
// Invariant: all SIMD targets compute the same bits.
#pragma once

#include <cstddef>
#include <span>

#include "base/simd.h"

namespace throng {

/// Interpolation of four rows: `from`, the next phase's by u, and both of the next speed by v.
struct RowBlend {
  const float* from;
  float u, v;
};

/// Writes `columns` floats per blend. Strides: floats to the next phase's and the next speed's row.
void blend_rows(std::span<const RowBlend> blends, size_t phase_stride, size_t speed_stride,
                size_t columns, float* out, SimdTarget target);

}  // namespace throng
