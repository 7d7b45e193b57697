// Columns as lanes. If a row is not a multiple of a register, its last columns are computed twice.
#include "avatars/gait/row_blend.h"

#include "base/simd/dispatch.h"
#include "base/simd/scalar_lanes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "avatars/gait/row_blend.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace {

template <class D>
HWY_INLINE void blend_all_by(D d, std::span<const RowBlend> blends, size_t phase_stride,
                             size_t speed_stride, size_t columns, float* out) {
  constexpr size_t kStep = hn::MaxLanes(D());
  for (const RowBlend& row : blends) {
    const auto blend_at = [&](size_t at) HWY_ATTR {
      store_bilinear(d, row.from + at, phase_stride, speed_stride, row.u, row.v, out + at);
    };
    size_t at = 0;
    for (; at + kStep <= columns; at += kStep) blend_at(at);
    if (at < columns) blend_at(columns - kStep);
    out += columns;
  }
}

}  // namespace

void blend_all(std::span<const RowBlend> blends, size_t phase_stride, size_t speed_stride,
               size_t columns, float* out) {
  if (columns >= kLanes) {
    blend_all_by(Lanes(), blends, phase_stride, speed_stride, columns, out);
  } else {
    const hn::CappedTag<float, 1> one;
    blend_all_by(one, blends, phase_stride, speed_stride, columns, out);
  }
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {
namespace {

void blend_scalar(std::span<const RowBlend> blends, size_t phase_stride, size_t speed_stride,
                  size_t columns, float* out) {
  for (const RowBlend& row : blends) {
    for (size_t i = 0; i < columns; ++i)
      out[i] = bilinear(row.from + i, phase_stride, speed_stride, row.u, row.v);
    out += columns;
  }
}

}  // namespace

void blend_rows(std::span<const RowBlend> blends, size_t phase_stride, size_t speed_stride,
                size_t columns, float* out, SimdTarget target) {
  THRONG_CHOOSE(resolved(target), blend_all, blend_scalar)
  (blends, phase_stride, speed_stride, columns, out);
}

}  // namespace throng
#endif
