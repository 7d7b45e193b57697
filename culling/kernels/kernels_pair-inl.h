// One or-DOP against one other with Highway, compiled once a target: the directions of one as
// lanes. Included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_PAIR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_PAIR_INL_H_
#undef THRONG_CULLING_KERNELS_PAIR_INL_H_
#else
#define THRONG_CULLING_KERNELS_PAIR_INL_H_
#endif

#include <hwy/highway.h>

#include "culling/kernels/kernels.h"
#include "culling/kernels/kernels_bound-inl.h"
#include "culling/volumes/ordop_pair.h"

#if THRONG_HAS_LANES  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {

/// True if a direction of own separates; the operations are those of the scalar reference.
template <int K>
HWY_INLINE bool half_separates(const OrdopLanes& own, const OrdopTable& other,
                               const OrdopHalf& half) {
  const Lanes tag;
  const auto set = [&](float value) { return hn::Set(tag, value); };
  const auto vector = [&](const float(&v)[3]) { return V3{set(v[0]), set(v[1]), set(v[2])}; };
  const V3 rows[3] = {vector(half.other_from_own[0]), vector(half.other_from_own[1]),
                      vector(half.other_from_own[2])};
  const V3 offset = vector(half.offset);
  constexpr size_t kUsed = K == 18 ? kAxisDirections + kEdgeDirections : kDirections.size();
  for (size_t first = 0; first < kUsed; first += kLanes) {
    const V3 n{hn::Load(tag, kDirectionLanes.x + first), hn::Load(tag, kDirectionLanes.y + first),
               hn::Load(tag, kDirectionLanes.z + first)};
    const V3 d{dot(n, rows[0]), dot(n, rows[1]), dot(n, rows[2])};
    const Interval far = bound<K, AxisSlabs::kDiffer>(other, d);
    const V between =
        hn::Sub(hn::Add(dot(n, offset), far.centre), hn::Load(tag, own.centre + first));
    const V along = hn::Mul(set(half.margin), hn::Load(tag, kDirectionLanes.length + first));
    const V reach = hn::Add(hn::Add(hn::Load(tag, own.half + first), far.half), along);
    if (!hn::AllFalse(tag, hn::Gt(hn::Abs(between), reach))) return true;
  }
  return false;
}

template <int K>
HWY_NOINLINE bool ordop_pair(const OrdopLanes& a, const PartPose& pose_a, float scale_a,
                             const OrdopLanes& b, const PartPose& pose_b, float scale_b,
                             const float (&shift_m)[4]) {
  const OrdopHalves halves(a.table, pose_a, scale_a, b.table, pose_b, scale_b, shift_m);
  return !half_separates<K>(a, b.table, halves.from_a) &&
         !half_separates<K>(b, a.table, halves.from_b);
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // THRONG_HAS_LANES

#endif  // per-target include guard
