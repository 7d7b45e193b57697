// Columns as lanes. Where a row is not a multiple of a register, its last columns are done twice.
#include "avatars/gait/row_blend.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "avatars/gait/row_blend.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
constexpr size_t kLanes = hn::MaxLanes(Tag());

template <class D>
HWY_INLINE void blend_at(D d, const RowBlend& row, size_t at, size_t next_phase, size_t next_speed,
                         float* out) {
  const auto between = [d](auto from, auto to, auto share) {
    return hn::Add(from, hn::Mul(share, hn::Sub(to, from)));
  };
  const float* from = row.from + at;
  const auto u = hn::Set(d, row.u), v = hn::Set(d, row.v);
  const auto slow = between(hn::LoadU(d, from), hn::LoadU(d, from + next_phase), u);
  from += next_speed;
  const auto fast = between(hn::LoadU(d, from), hn::LoadU(d, from + next_phase), u);
  hn::StoreU(between(slow, fast, v), d, out + at);
}

template <class D>
HWY_INLINE void blend_all_by(D d, std::span<const RowBlend> blends, size_t next_phase,
                             size_t next_speed, size_t columns, float* out) {
  constexpr size_t kStep = hn::MaxLanes(D());
  for (const RowBlend& row : blends) {
    size_t at = 0;
    for (; at + kStep <= columns; at += kStep) blend_at(d, row, at, next_phase, next_speed, out);
    if (at < columns) blend_at(d, row, columns - kStep, next_phase, next_speed, out);
    out += columns;
  }
}

}  // namespace

void blend_all(std::span<const RowBlend> blends, size_t next_phase, size_t next_speed,
               size_t columns, float* out) {
  if (columns >= kLanes) {
    blend_all_by(Tag(), blends, next_phase, next_speed, columns, out);
  } else {
    const hn::CappedTag<float, 1> one;
    blend_all_by(one, blends, next_phase, next_speed, columns, out);
  }
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {
namespace {

void blend_one_by_one(std::span<const RowBlend> blends, size_t next_phase, size_t next_speed,
                      size_t columns, float* out) {
  for (const RowBlend& row : blends) {
    const float *a = row.from, *b = a + next_phase, *c = a + next_speed, *d = c + next_phase;
    for (size_t i = 0; i < columns; ++i) {
      const float slow = a[i] + row.u * (b[i] - a[i]);
      const float fast = c[i] + row.u * (d[i] - c[i]);
      out[i] = slow + row.v * (fast - slow);
    }
    out += columns;
  }
}

}  // namespace

void blend_rows(std::span<const RowBlend> blends, size_t next_phase, size_t next_speed,
                size_t columns, float* out, SimdTarget target) {
  switch (resolved(target)) {
#if HWY_TARGETS & HWY_SSE4
    case SimdTarget::kSse4:
      return N_SSE4::blend_all(blends, next_phase, next_speed, columns, out);
#endif
#if HWY_TARGETS & HWY_AVX2
    case SimdTarget::kAvx2:
      return N_AVX2::blend_all(blends, next_phase, next_speed, columns, out);
#endif
#if HWY_TARGETS & HWY_AVX3
    case SimdTarget::kAvx512:
      return N_AVX3::blend_all(blends, next_phase, next_speed, columns, out);
#endif
    default:
      return blend_one_by_one(blends, next_phase, next_speed, columns, out);
  }
}

}  // namespace throng
#endif
