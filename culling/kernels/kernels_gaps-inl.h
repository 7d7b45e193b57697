// How far apart parts are, with Highway, compiled once a target: pairs of the same two part shapes
// as lanes. Included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_GAPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_GAPS_INL_H_
#undef THRONG_CULLING_KERNELS_GAPS_INL_H_
#else
#define THRONG_CULLING_KERNELS_GAPS_INL_H_
#endif

#include <hwy/highway.h>

#include "culling/kernels/kernels.h"
#include "culling/kernels/kernels_ordop-inl.h"

#if THRONG_HAS_LANES  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {

/// How far apart two or-DOPs are along one of own's directions, the one that parts them most, over
/// own's scale; below 0 where none does.
template <typename Each>
HWY_INLINE V widest_gap(const HalfTest<26>& half, const Each& each) {
  const Lanes tag;
  V most = hn::Set(tag, -kEmptyLow);
  each(half, [&](size_t index, const V3& d, V tau) HWY_ATTR {
    const Interval far = bound<26>(half.other, d);
    const Slab& near = half.own.slabs.slab[index];
    V between = hn::Add(tau, far.centre);
    if (index >= kAxisDirections) between = hn::Sub(between, hn::Set(tag, near.centre));
    const V beyond = hn::Sub(hn::Abs(between), hn::Add(hn::Set(tag, near.half), far.half));
    most = hn::Max(most, hn::Mul(beyond, hn::Set(tag, half.own.per_length[index])));
  });
  return most;
}

/// Two parts, all that their gap is found from.
struct GapLanes {
  static constexpr size_t kRows = Relative::kRows + 7;
  Relative relative;
  V3 root;  ///< of b, from a's, in a's frame
  V scale_a, scale_b, margin;
  V most;  ///< the widest gap so far

  GapLanes() = default;
  GapLanes(const OrdopTable& a, const OrdopTable& b, const PairLanes& there)
      : relative(a, b, there),
        scale_a(there.scale_a),
        scale_b(there.scale_b),
        margin(there.margin),
        most(hn::Set(Lanes(), -kEmptyLow)) {
    const V3 between = (there.shift + there.b.translation) - there.a.translation;
    root = {dot(there.a.column[0], between), dot(there.a.column[1], between),
            dot(there.a.column[2], between)};
  }

  template <typename Visit>
  HWY_INLINE void each_row(const Visit& visit) {
    relative.each_row(visit);
    size_t row = Relative::kRows;
    visit(row++, root.x), visit(row++, root.y), visit(row++, root.z);
    visit(row++, scale_a), visit(row++, scale_b), visit(row++, margin), visit(row++, most);
  }

  /// Along some directions of both.
  template <typename Each>
  HWY_INLINE void widen(const OrdopTable& a, const OrdopTable& b, const Each& each) {
    const V along_a = hn::Mul(widest_gap(relative.from_a<26>(a, b), each), scale_a);
    const V along_b = hn::Mul(widest_gap(relative.from_b<26>(a, b), each), scale_b);
    most = hn::Max(most, hn::Max(along_a, along_b));
  }
  HWY_INLINE V lo() const {
    const Lanes d;
    return hn::Max(hn::Sub(hn::Mul(most, hn::Set(d, kGapDown)), margin), hn::Zero(d));
  }
};

/// The one of a part's first points that is nearest to another, in the part's frame.
template <size_t kOf = SpreadPoints::kCount>
HWY_INLINE V3 nearest_of(const SpreadPoints& points, const V3& to) {
  const Lanes tag;
  V3 best = {hn::Set(tag, points.x[0]), hn::Set(tag, points.y[0]), hn::Set(tag, points.z[0])};
  const V3 first = best - to;
  V least2 = dot(first, first);
  for (size_t i = 1; i < kOf; ++i) {
    const V3 point = {hn::Set(tag, points.x[i]), hn::Set(tag, points.y[i]),
                      hn::Set(tag, points.z[i])};
    const V3 between = point - to;
    const V apart2 = dot(between, between);
    const M nearer = hn::Lt(apart2, least2);
    least2 = hn::IfThenElse(nearer, apart2, least2);
    best = {hn::IfThenElse(nearer, point.x, best.x), hn::IfThenElse(nearer, point.y, best.y),
            hn::IfThenElse(nearer, point.z, best.z)};
  }
  return best;
}

/// From the middle of b to the nearest of a few points of a, from there to the nearest of b's, and
/// from there to the nearest of a's.
HWY_INLINE V point_to_point(const SpreadPoints& on_a, const SpreadPoints& on_b,
                            const OrdopTable& table_b, const GapLanes& there) {
  const Lanes tag;
  const V one = hn::Set(tag, 1.0f);
  const V per_a = hn::Div(one, there.scale_a), per_b = hn::Div(one, there.scale_b);
  const V3& root = there.root;
  const auto& axes = there.relative.axes;
  const auto from_a = [&](const V3& b) HWY_ATTR {  // metres, not yet over a's scale
    const V3 scaled_b = b * there.scale_b;
    const V3 turned_b = {dot({axes[0][0], axes[1][0], axes[2][0]}, scaled_b),
                         dot({axes[0][1], axes[1][1], axes[2][1]}, scaled_b),
                         dot({axes[0][2], axes[1][2], axes[2][2]}, scaled_b)};
    return root + turned_b;
  };
  const auto from_b = [&](const V3& a) HWY_ATTR {
    const V3 away = a * there.scale_a - root;
    return V3{dot({axes[0][0], axes[0][1], axes[0][2]}, away),
              dot({axes[1][0], axes[1][1], axes[1][2]}, away),
              dot({axes[2][0], axes[2][1], axes[2][2]}, away)} *
           per_b;
  };
  V3 b = {hn::Set(tag, table_b.origin[0]), hn::Set(tag, table_b.origin[1]),
          hn::Set(tag, table_b.origin[2])};
  V3 a = nearest_of<SpreadPoints::kFew>(on_a, from_a(b) * per_a);
  b = nearest_of(on_b, from_b(a));
  a = nearest_of(on_a, from_a(b) * per_a);
  const V3 apart = a * there.scale_a - from_a(b);
  return hn::Sqrt(dot(apart, apart));
}

/// The box directions first, then the others, then points: each for those that the ones before
/// leave within near_m, packed into full registers.
HWY_NOINLINE void ordop_gaps(const OrdopTable& a, const OrdopTable& b, const SpreadPoints& on_a,
                             const SpreadPoints& on_b, const BodyPair* pairs, const PartPose* poses,
                             const Candidate* candidates, const uint32_t* order, size_t count,
                             float near_m, GapBounds* bounds) {
  const Lanes d;
  const LaneBits bits;
  const V within = hn::Set(d, near_m);
  HWY_ALIGN float found[kLanes];
  const auto take_lo = [&](GapLanes& there, const uint32_t* index, size_t in_use,
                           Undecided<GapLanes>& left) HWY_ATTR {
    const V lo = there.lo();
    hn::Store(lo, d, found);
    for (size_t lane = 0; lane < in_use; ++lane) bounds[index[lane]].lo_m = found[lane];
    const M used = hn::RebindMask(d, hn::FirstN(bits, in_use));
    left.add(there, index, hn::And(hn::Le(lo, within), used));
  };
  for (size_t chunk = 0; chunk < count; chunk += kChunk, order += kChunk) {
    const size_t in_chunk = HWY_MIN(count - chunk, kChunk);
    const ChunkInput input(pairs, candidates, order, in_chunk);
    Undecided<GapLanes> by_axes, by_all;
    for (size_t first = 0; first < in_chunk; first += kLanes) {
      GapLanes there(a, b, PairLanes(poses, input, first));
      there.widen(a, b,
                  [](const auto& half, const auto& visit) HWY_ATTR { half.each_axis(visit); });
      take_lo(there, input.order + first, HWY_MIN(kLanes, in_chunk - first), by_axes);
    }
    for (size_t first = 0; first < by_axes.count; first += kLanes) {
      GapLanes there = by_axes.at(first);
      there.widen(a, b, [](const auto& half, const auto& visit) HWY_ATTR {
        half.each_edge(visit);
        half.each_corner(visit);
      });
      take_lo(there, by_axes.index + first, HWY_MIN(kLanes, by_axes.count - first), by_all);
    }
    for (size_t first = 0; first < by_all.count; first += kLanes) {
      const GapLanes there = by_all.at(first);
      const V apart = point_to_point(on_a, on_b, b, there);
      hn::Store(hn::Add(hn::Mul(apart, hn::Set(d, kGapUp)), there.margin), d, found);
      const size_t in_use = HWY_MIN(kLanes, by_all.count - first);
      for (size_t lane = 0; lane < in_use; ++lane)
        bounds[by_all.index[first + lane]].hi_m = found[lane];
    }
  }
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // THRONG_HAS_LANES

#endif  // per-target include guard
