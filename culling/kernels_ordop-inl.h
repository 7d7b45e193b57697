// or-DOP against or-DOP with Highway, compiled once a target: pairs of the same two part shapes as
// lanes. Included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_ORDOP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_ORDOP_INL_H_
#undef THRONG_CULLING_KERNELS_ORDOP_INL_H_
#else
#define THRONG_CULLING_KERNELS_ORDOP_INL_H_
#endif

#include <hwy/highway.h>

#include "culling/kernels.h"
#include "culling/kernels_bound-inl.h"
#include "culling/volumes/directions.h"

#if HWY_TARGET != HWY_SCALAR  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Separating axes along the directions of one or-DOP ("own") against another ("other"), in units
/// of own's scale, so that own's slabs are constants.
template <int K>
struct HalfTest {
  const OrdopTable& own;
  const OrdopTable& other;
  V3 column[3];  ///< own's axes in other's frame, times other's scale over own's
  V3 offset;     ///< other's centre in own's frame
  V margin;

  /// True where direction `index` of own, `d` in other's frame, separates; tau = direction .
  /// offset.
  HWY_INLINE M separates(size_t index, const V3& d, V tau, V margin_along) const {
    const Lanes tag;
    const Interval far = bound<K>(other, d);
    const Slab& near = own.slabs.slab[index];
    V between = hn::Add(tau, far.centre);
    if (index >= kAxisDirections) between = hn::Sub(between, hn::Set(tag, near.centre));
    const V reach = hn::Add(hn::Add(hn::Set(tag, near.half), far.half), margin_along);
    return hn::Gt(hn::Abs(between), reach);
  }
  HWY_INLINE M axes() const {
    const M x = separates(0, column[0], offset.x, margin);
    const M y = separates(1, column[1], offset.y, margin);
    const M z = separates(2, column[2], offset.z, margin);
    return hn::Or(x, hn::Or(y, z));
  }
  HWY_INLINE M edges() const {
    const V3 &x = column[0], &y = column[1], &z = column[2];
    const V along = hn::Mul(margin, hn::Set(Lanes(), kEdgeLength));
    M out = separates(3, y + z, hn::Add(offset.y, offset.z), along);
    out = hn::Or(out, separates(4, y - z, hn::Sub(offset.y, offset.z), along));
    out = hn::Or(out, separates(5, x + z, hn::Add(offset.x, offset.z), along));
    out = hn::Or(out, separates(6, x - z, hn::Sub(offset.x, offset.z), along));
    out = hn::Or(out, separates(7, x + y, hn::Add(offset.x, offset.y), along));
    return hn::Or(out, separates(8, x - y, hn::Sub(offset.x, offset.y), along));
  }
  HWY_INLINE M corners() const {
    const V along = hn::Mul(margin, hn::Set(Lanes(), kCornerLength));
    const V3 sum = column[0] + column[1], difference = column[0] - column[1];
    const V3& z = column[2];
    const V plus = hn::Add(offset.x, offset.y), minus = hn::Sub(offset.x, offset.y);
    M out = separates(9, sum + z, hn::Add(plus, offset.z), along);
    out = hn::Or(out, separates(10, sum - z, hn::Sub(plus, offset.z), along));
    out = hn::Or(out, separates(11, difference + z, hn::Add(minus, offset.z), along));
    return hn::Or(out, separates(12, difference - z, hn::Sub(minus, offset.z), along));
  }
};

/// Both halves of the test for a register of candidates of one bucket.
template <int K>
struct PairTest {
  HalfTest<K> from_a, from_b;

  /// The lanes from order[0] on; lanes beyond the last candidate repeat it.
  PairTest(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs, const PartPose* poses,
           const Candidate* candidates, const uint32_t* order, size_t in_use)
      : from_a{a, b, {}, {}, {}}, from_b{b, a, {}, {}, {}} {
    const BodyPair* pair_of[kLanes];
    const PartPose* pose_a[kLanes];
    const PartPose* pose_b[kLanes];
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const Candidate& c = candidates[order[HWY_MIN(lane, in_use - 1)]];
      pair_of[lane] = &pairs[c.pair];
      pose_a[lane] = &poses[pair_of[lane]->pose_a + c.part_a];
      pose_b[lane] = &poses[pair_of[lane]->pose_b + c.part_b];
    }
    const Poses pa = load_poses([&](size_t lane) { return pose_a[lane]; });
    const Poses pb = load_poses([&](size_t lane) { return pose_b[lane]; });
    V shift[4], scales[4];
    load_rows([&](size_t lane) { return &pair_of[lane]->shift_m[0]; }, shift);
    load_rows([&](size_t lane) { return &pair_of[lane]->scale_a; }, scales);
    const V3 delta = (V3{shift[0], shift[1], shift[2]} + centre_of(b, pb, scales[1])) -
                     centre_of(a, pa, scales[0]);
    set_halves(pa, pb, delta, scales[0], scales[1], shift[3]);
  }

  /// Lanes that a box direction of either separates: three in four of all that are apart.
  HWY_INLINE M apart_by_axes() const { return hn::Or(from_a.axes(), from_b.axes()); }
  HWY_INLINE M apart_by_the_rest() const {
    if constexpr (K == 14) return hn::Or(from_a.corners(), from_b.corners());
    const M by_edges = hn::Or(from_a.edges(), from_b.edges());
    if constexpr (K == 18) return by_edges;
    if (hn::AllTrue(Lanes(), by_edges)) return by_edges;
    return hn::Or(by_edges, hn::Or(from_a.corners(), from_b.corners()));
  }

 private:
  HWY_INLINE void set_halves(const Poses& pa, const Poses& pb, const V3& delta, V scale_a,
                             V scale_b, V margin) {
    V relative[3][3];  // [i][j]: axis i of b . axis j of a
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) relative[i][j] = dot(pb.column[i], pa.column[j]);
    const V one = hn::Set(Lanes(), 1.0f);
    const V per_a = hn::Div(one, scale_a), per_b = hn::Div(one, scale_b);
    const V b_over_a = hn::Mul(scale_b, per_a), a_over_b = hn::Mul(scale_a, per_b);
    for (size_t j = 0; j < 3; ++j) {
      from_a.column[j] = V3{relative[0][j], relative[1][j], relative[2][j]} * b_over_a;
      from_b.column[j] = V3{relative[j][0], relative[j][1], relative[j][2]} * a_over_b;
    }
    from_a.offset =
        V3{dot(pa.column[0], delta), dot(pa.column[1], delta), dot(pa.column[2], delta)} * per_a;
    from_b.offset = V3{hn::Neg(dot(pb.column[0], delta)), hn::Neg(dot(pb.column[1], delta)),
                       hn::Neg(dot(pb.column[2], delta))} *
                    per_b;
    from_a.margin = hn::Mul(margin, per_a);
    from_b.margin = hn::Mul(margin, per_b);
  }
};

/// Candidates that the box directions leave undecided are collected and tested together: half of
/// all lanes would otherwise wait for the others.
inline constexpr size_t kChunk = 256;

template <int K>
HWY_NOINLINE void ordop_pairs(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                              const PartPose* poses, const Candidate* candidates,
                              const uint32_t* order, size_t count, uint8_t* overlaps) {
  for (size_t chunk = 0; chunk < count; chunk += kChunk) {
    const size_t chunk_end = HWY_MIN(count, chunk + kChunk);
    uint32_t undecided[kChunk];
    size_t left = 0;
    for (size_t first = chunk; first < chunk_end; first += kLanes) {
      const size_t in_use = HWY_MIN(kLanes, chunk_end - first);
      const PairTest<K> test(a, b, pairs, poses, candidates, order + first, in_use);
      const uint32_t apart = bits_of(test.apart_by_axes());
      for (size_t lane = 0; lane < in_use; ++lane) {
        undecided[left] = order[first + lane];
        left += ((apart >> lane) & 1) ^ 1;
        overlaps[order[first + lane]] = 0;
      }
    }
    for (size_t first = 0; first < left; first += kLanes) {
      const size_t in_use = HWY_MIN(kLanes, left - first);
      const PairTest<K> test(a, b, pairs, poses, candidates, undecided + first, in_use);
      const uint32_t apart = bits_of(test.apart_by_the_rest());
      for (size_t lane = 0; lane < in_use; ++lane)
        overlaps[undecided[first + lane]] = ((apart >> lane) & 1) ^ 1;
    }
  }
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // HWY_SCALAR

#endif  // per-target include guard
