// Rows between the nodes of a table, many at a time. Internal to the folder.
// One rule: every target gives the same bits.
#pragma once

#include <cstddef>
#include <span>

#include "base/simd.h"

namespace throng {

/// A row between four: `from`, the next phase's by u, and both of the next speed by v.
struct RowBlend {
  const float* from;
  float u, v;
};

/// Writes `columns` floats each; the next phase's row lies phase_stride floats on, the next speed's
/// speed_stride.
void blend_rows(std::span<const RowBlend> blends, size_t phase_stride, size_t speed_stride,
                size_t columns, float* out, SimdTarget target);

}  // namespace throng
