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

/// How far apart two or-DOPs are along directions of own, the ones that part them most.
struct Gap {
  V widest;         ///< over own's scale; below 0 where none parts them
  V beyond_margin;  ///< above 0 where one separates them, see HalfTest::separates()
};
template <typename Each>
HWY_INLINE Gap gap_along(const HalfTest<26>& half, const Each& each) {
  const Lanes tag;
  Gap most = {hn::Set(tag, -kEmptyLow), hn::Set(tag, -kEmptyLow)};
  each(half, [&](size_t index, const V3& d, V tau) HWY_ATTR {
    const auto [apart, reach] = half.along(index, d, tau);
    const V gap = hn::Mul(hn::Sub(apart, reach), hn::Set(tag, half.own.per_length[index]));
    most.widest = hn::Max(most.widest, gap);
    most.beyond_margin =
        hn::Max(most.beyond_margin, hn::Sub(apart, half.with_margin(index, reach)));
  });
  return most;
}

/// Part b from part a, all that a distance of points is found from, and what is known of it.
struct PointLanes {
  static constexpr size_t kRows = 17;
  V axes[3][3];  ///< [i][j]: axis i of b . axis j of a
  V3 root;       ///< of b, from a's, in a's frame
  V scale_a, scale_b, margin;
  V lo, beyond_margin;  ///< see GapLanes

  template <typename Visit>
  HWY_INLINE void each_row(const Visit& visit) {
    for (size_t i = 0; i < 9; ++i) visit(i, axes[i / 3][i % 3]);
    visit(9, root.x), visit(10, root.y), visit(11, root.z);
    visit(12, scale_a), visit(13, scale_b), visit(14, margin), visit(15, lo);
    visit(16, beyond_margin);
  }
};

/// Two parts, all that their gap is found from.
struct GapLanes {
  static constexpr size_t kRows = Relative::kRows + 8;
  Relative relative;
  V3 root;  ///< of b, from a's, in a's frame
  V scale_a, scale_b, margin;
  V widest, beyond_margin;  ///< of the gaps so far

  GapLanes() = default;
  GapLanes(const OrdopTable& a, const OrdopTable& b, const PairLanes& there)
      : relative(a, b, there),
        scale_a(there.scale_a),
        scale_b(there.scale_b),
        margin(there.margin),
        widest(hn::Set(Lanes(), -kEmptyLow)),
        beyond_margin(widest) {
    const V3 between = (there.shift + there.b.translation) - there.a.translation;
    root = {dot(there.a.column[0], between), dot(there.a.column[1], between),
            dot(there.a.column[2], between)};
  }

  template <typename Visit>
  HWY_INLINE void each_row(const Visit& visit) {
    relative.each_row(visit);
    size_t row = Relative::kRows;
    visit(row++, root.x), visit(row++, root.y), visit(row++, root.z);
    visit(row++, scale_a), visit(row++, scale_b), visit(row++, margin), visit(row++, widest);
    visit(row++, beyond_margin);
  }
  HWY_INLINE PointLanes points() const {
    const auto& axes = relative.axes;
    return {{{axes[0][0], axes[0][1], axes[0][2]},
             {axes[1][0], axes[1][1], axes[1][2]},
             {axes[2][0], axes[2][1], axes[2][2]}},
            root,
            scale_a,
            scale_b,
            margin,
            lo(),
            beyond_margin};
  }

  /// Along some directions of both.
  template <typename Each>
  HWY_INLINE void widen(const OrdopTable& a, const OrdopTable& b, const Each& each) {
    const Gap along_a = gap_along(relative.from_a<26>(a, b), each);
    const Gap along_b = gap_along(relative.from_b<26>(a, b), each);
    widest = hn::Max(widest,
                     hn::Max(hn::Mul(along_a.widest, scale_a), hn::Mul(along_b.widest, scale_b)));
    beyond_margin = hn::Max(beyond_margin, hn::Max(along_a.beyond_margin, along_b.beyond_margin));
  }
  HWY_INLINE V lo() const {
    const Lanes d;
    return hn::Max(hn::Sub(hn::Mul(widest, hn::Set(d, kGapDown)), margin), hn::Zero(d));
  }
};

/// A point of the part near `to`, in its frame.
HWY_INLINE V3 nearby(const NearbyPoints& on, const V3& to) {
  const Lanes d;
  const auto cells_along = [&](const NearbyPoints::Axis& axis, V x) HWY_ATTR {
    const V at = hn::Mul(hn::Sub(x, hn::Set(d, axis.low_m)), hn::Set(d, axis.per_m));
    const V inside = hn::Min(hn::Max(at, hn::Zero(d)), hn::Set(d, axis.last));
    return hn::Mul(hn::Floor(inside), hn::Set(d, axis.stride));  // whole numbers from here on
  };
  const V cell = hn::Add(hn::Add(cells_along(on.axes[0], to.x), cells_along(on.axes[1], to.y)),
                         cells_along(on.axes[2], to.z));
  const hn::RebindToSigned<Lanes> whole;
  HWY_ALIGN int32_t cells[kLanes];
  hn::Store(hn::ConvertTo(whole, cell), whole, cells);
  V point[4];
  load_rows([&](size_t lane) { return &on.of_cell(static_cast<size_t>(cells[lane])).x; }, point);
  return {point[0], point[1], point[2]};
}

/// From the middle of b to a point of a, from there to one of b's, and from there to one of a's.
HWY_INLINE V point_to_point(const NearbyPoints& on_a, const NearbyPoints& on_b,
                            const OrdopTable& table_b, const PointLanes& there) {
  const Lanes tag;
  const V one = hn::Set(tag, 1.0f);
  const V per_a = hn::Div(one, there.scale_a), per_b = hn::Div(one, there.scale_b);
  const V3& root = there.root;
  const auto& axes = there.axes;
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
  V3 a = nearby(on_a, from_a(b) * per_a);
  b = nearby(on_b, from_b(a));
  a = nearby(on_a, from_a(b) * per_a);
  const V3 apart = a * there.scale_a - from_a(b);
  return hn::Sqrt(dot(apart, apart));
}

/// The box directions first, then the others, then points: each for those that the ones before
/// leave within near_m, packed into full registers.
HWY_NOINLINE void ordop_gaps(const OrdopTable& a, const OrdopTable& b, const NearbyPoints& on_a,
                             const NearbyPoints& on_b, const BodyPair* pairs, const PartPose* poses,
                             const Candidate* candidates, const uint32_t* order, size_t count,
                             float near_m, GapBounds* bounds, uint8_t* overlaps) {
  const Lanes d;
  const LaneBits bits;
  const V within = hn::Set(d, near_m);
  HWY_ALIGN float los[kLanes], his[kLanes], beyond_margin[kLanes];
  const auto near = [&](V lo, size_t in_use) HWY_ATTR {
    return hn::And(hn::Le(lo, within), hn::RebindMask(d, hn::FirstN(bits, in_use)));
  };
  for (size_t chunk = 0; chunk < count; chunk += kChunk, order += kChunk) {
    const size_t in_chunk = HWY_MIN(count - chunk, kChunk);
    const ChunkInput input(pairs, candidates, order, in_chunk);
    Undecided<GapLanes> by_axes;
    Undecided<PointLanes> by_all;
    for (size_t first = 0; first < in_chunk; first += kLanes) {
      GapLanes there(a, b, PairLanes(poses, input, first));
      there.widen(a, b,
                  [](const auto& half, const auto& visit) HWY_ATTR { half.each_axis(visit); });
      by_axes.add(there, input.order + first, near(there.lo(), HWY_MIN(kLanes, in_chunk - first)));
    }
    for (size_t first = 0; first < by_axes.count; first += kLanes) {
      GapLanes there = by_axes.at(first);
      there.widen(a, b, [](const auto& half, const auto& visit) HWY_ATTR {
        half.each_edge(visit);
        half.each_corner(visit);
      });
      PointLanes points = there.points();
      by_all.add(points, by_axes.index + first,
                 near(points.lo, HWY_MIN(kLanes, by_axes.count - first)));
    }
    for (size_t first = 0; first < by_all.count; first += kLanes) {
      const PointLanes there = by_all.at(first);
      const V apart = point_to_point(on_a, on_b, b, there);
      hn::Store(there.lo, d, los);
      hn::Store(there.beyond_margin, d, beyond_margin);
      hn::Store(hn::Add(hn::Mul(apart, hn::Set(d, kGapUp)), there.margin), d, his);
      const size_t in_use = HWY_MIN(kLanes, by_all.count - first);
      for (size_t lane = 0; lane < in_use; ++lane) {
        bounds[by_all.index[first + lane]] = {los[lane], his[lane]};
        overlaps[by_all.index[first + lane]] = !(beyond_margin[lane] > 0);
      }
    }
  }
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // THRONG_HAS_LANES

#endif  // per-target include guard
