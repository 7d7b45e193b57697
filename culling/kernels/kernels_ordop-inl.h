// kernels_ordop-inl.h tests or-DOPs with Highway, pairs of the same two part shapes as lanes.
// Compiled once per target; included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_ORDOP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_ORDOP_INL_H_
#undef THRONG_CULLING_KERNELS_ORDOP_INL_H_
#else
#define THRONG_CULLING_KERNELS_ORDOP_INL_H_
#endif

#include <hwy/highway.h>

#include "culling/kernels/kernels.h"
#include "culling/kernels/kernels_lanes-inl.h"
#include "culling/volumes/ordop_table.h"

#if THRONG_HAS_LANES  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {

HWY_INLINE M nowhere() { return hn::RebindMask(Lanes(), hn::FirstN(LaneBits(), 0)); }

/// Tests separating axes along the directions of one or-DOP ("own") against another ("other"), in
/// units of own's half sides and scale. Own's slabs are then constants.
template <int K>
struct HalfTest {
  const OrdopTable& own;
  const OrdopTable& other;
  V3 column[3];  ///< own's axes in other's frame and units
  V3 offset;     ///< other's centre in own's frame and units
  V margin;      ///< divided by own's scale

  /// Both or-DOPs along direction `index` of own; `d`: in other's frame; tau = direction . offset.
  struct Along {
    V apart;  ///< distance of the middles
    V reach;  ///< sum of the half widths
  };
  HWY_INLINE Along along(size_t index, const V3& d, V tau) const {
    const Lanes tag;
    const Interval far = bound<K>(other, d);
    const Slab& near = own.slabs.slab[index];
    V between = hn::Add(tau, far.centre);
    if (index >= kAxisDirections) between = hn::Sub(between, hn::Set(tag, near.centre));
    return {hn::Abs(between), hn::Add(hn::Set(tag, near.half), far.half)};
  }
  /// Maximum distance of the middles that does not separate.
  HWY_INLINE V with_margin(size_t index, V reach) const {
    return hn::Add(reach, hn::Mul(margin, hn::Set(Lanes(), own.length[index])));
  }
  HWY_INLINE M separates(size_t index, const V3& d, V tau) const {
    const Along there = along(index, d, tau);
    return hn::Gt(there.apart, with_margin(index, there.reach));
  }
  /// Calls visit(index, direction in other's frame, tau) for own's directions.
  template <typename Visit>
  HWY_INLINE void each_axis(const Visit& visit) const {
    visit(0, column[0], offset.x);
    visit(1, column[1], offset.y);
    visit(2, column[2], offset.z);
  }
  template <typename Visit>
  HWY_INLINE void each_edge(const Visit& visit) const {
    const V3 &x = column[0], &y = column[1], &z = column[2];
    visit(3, y + z, hn::Add(offset.y, offset.z));
    visit(4, y - z, hn::Sub(offset.y, offset.z));
    visit(5, x + z, hn::Add(offset.x, offset.z));
    visit(6, x - z, hn::Sub(offset.x, offset.z));
    visit(7, x + y, hn::Add(offset.x, offset.y));
    visit(8, x - y, hn::Sub(offset.x, offset.y));
  }
  template <typename Visit>
  HWY_INLINE void each_corner(const Visit& visit) const {
    const V3 sum = column[0] + column[1], difference = column[0] - column[1];
    const V3& z = column[2];
    const V plus = hn::Add(offset.x, offset.y), minus = hn::Sub(offset.x, offset.y);
    visit(9, sum + z, hn::Add(plus, offset.z));
    visit(10, sum - z, hn::Sub(plus, offset.z));
    visit(11, difference + z, hn::Add(minus, offset.z));
    visit(12, difference - z, hn::Sub(minus, offset.z));
  }

  HWY_INLINE M axes() const {
    return any_separates([this](const auto& visit) HWY_ATTR { each_axis(visit); });
  }
  HWY_INLINE M edges() const {
    return any_separates([this](const auto& visit) HWY_ATTR { each_edge(visit); });
  }
  HWY_INLINE M corners() const {
    return any_separates([this](const auto& visit) HWY_ATTR { each_corner(visit); });
  }
  template <typename Each>
  HWY_INLINE M any_separates(const Each& each) const {
    M out = nowhere();
    each([&](size_t index, const V3& d, V tau)
             HWY_ATTR { out = hn::Or(out, separates(index, d, tau)); });
    return out;
  }

  /// Distance of other's centre over own's extent in that direction: at most 1 inside own.
  HWY_INLINE V centre_over_reach() const {
    const Lanes tag;
    const auto in_units = [&](size_t index, V tau) {
      return hn::Max(hn::Mul(tau, hn::Set(tag, own.per_reach_up[index])),
                     hn::Mul(tau, hn::Set(tag, own.per_reach_down[index])));
    };
    const V3& o = offset;
    V max = hn::Max(in_units(0, o.x), hn::Max(in_units(1, o.y), in_units(2, o.z)));
    const auto extend = [&](size_t index, V tau) { max = hn::Max(max, in_units(index, tau)); };
    const V plus = hn::Add(o.x, o.y), minus = hn::Sub(o.x, o.y);
    if constexpr (K != 14) {
      extend(3, hn::Add(o.y, o.z)), extend(4, hn::Sub(o.y, o.z));
      extend(5, hn::Add(o.x, o.z)), extend(6, hn::Sub(o.x, o.z));
      extend(7, plus), extend(8, minus);
    }
    if constexpr (K != 18) {
      extend(9, hn::Add(plus, o.z)), extend(10, hn::Sub(plus, o.z));
      extend(11, hn::Add(minus, o.z)), extend(12, hn::Sub(minus, o.z));
    }
    return max;
  }
};

/// True if the line between the centres proves a common point, so that no direction separates. This
/// decides most overlapping pairs (docs/culling.md). Own contains the first 1 / m of the line, so
/// both contain a point if 1 / m_a + 1 / m_b >= 1. The margin exceeds the rounding.
template <int K>
HWY_INLINE M share_a_point(const HalfTest<K>& from_a, const HalfTest<K>& from_b) {
  if (!from_a.own.holds_origin || !from_b.own.holds_origin) return nowhere();
  const V one = hn::Set(Lanes(), 1.0f);
  const V beyond_a = hn::Sub(from_a.centre_over_reach(), one);
  const V beyond_b = hn::Sub(from_b.centre_over_reach(), one);
  return hn::Le(hn::Mul(beyond_a, beyond_b), one);
}

/// Number of candidates per chunk. Candidates undecided by the box directions and the line between
/// the centres are collected, because most lanes would otherwise wait for the others.
inline constexpr size_t kChunk = 128;

/// Inputs of the lanes of a chunk: the bucket's part a first, swapped or not.
struct ChunkInput {
  const BodyPair* pair[kChunk + kLanes];
  uint32_t pose_a[kChunk + kLanes], pose_b[kChunk + kLanes];
  HWY_ALIGN uint32_t turned[kChunk + kLanes];
  uint32_t order[kChunk + kLanes];

  /// Lanes beyond the last candidate, up to a full register, repeat it.
  ChunkInput(const BodyPair* pairs, const Candidate* candidates, const uint32_t* of_chunk,
             size_t count) {
    for (size_t i = 0; i < count; ++i) set(i, pairs, candidates, of_chunk[i]);
    for (size_t i = count; i < count + kLanes - 1; ++i)
      set(i, pairs, candidates, of_chunk[count - 1]);
  }

 private:
  HWY_INLINE void set(size_t i, const BodyPair* pairs, const Candidate* candidates,
                      uint32_t index) {
    const Candidate& c = candidates[index];
    const BodyPair& bodies = pairs[c.pair];
    const uint32_t a = bodies.pose_a + c.part_a, b = bodies.pose_b + c.part_b;
    const uint32_t turn = c.is_swapped(), exchange = (a ^ b) & (0 - turn);
    order[i] = index;
    pair[i] = &bodies;
    turned[i] = turn;
    pose_a[i] = a ^ exchange;
    pose_b[i] = b ^ exchange;
  }
};

/// Poses of the parts of a register's candidates, the bucket's part a first.
struct PairLanes {
  Poses a, b;
  V3 shift;  ///< root of b minus root of a
  V margin, scale_a, scale_b;

  PairLanes(const PartPose* poses, const ChunkInput& in, size_t first)
      : a(load_poses([&](size_t lane) { return &poses[in.pose_a[first + lane]]; })),
        b(load_poses([&](size_t lane) { return &poses[in.pose_b[first + lane]]; })) {
    const Lanes d;
    const LaneBits bits;
    V rows[4], scales[4];
    load_rows([&](size_t lane) { return &in.pair[first + lane]->shift_m[0]; }, rows);
    load_rows([&](size_t lane) { return &in.pair[first + lane]->scale_a; }, scales);
    const M turned = hn::RebindMask(d, hn::Ne(hn::Load(bits, in.turned + first), hn::Zero(bits)));
    const auto towards = [&](V v) { return hn::IfThenElse(turned, hn::Neg(v), v); };
    shift = {towards(rows[0]), towards(rows[1]), towards(rows[2])};
    margin = rows[3];
    scale_a = hn::IfThenElse(turned, scales[1], scales[0]);
    scale_b = hn::IfThenElse(turned, scales[0], scales[1]);
  }
};

/// Relative pose of two parts, for both halves of the test.
struct Relative {
  static constexpr size_t kRows = 19;
  V axes[3][3];  ///< [i][j]: axis i of b . axis j of a
  V3 offset_a;   ///< b's centre in a's frame and units
  V3 offset_b;   ///< a's centre in b's frame and units
  V margin_a, margin_b;
  V b_over_a, a_over_b;

  Relative() = default;
  Relative(const OrdopTable& a, const OrdopTable& b, const PairLanes& there) {
    const Lanes d;
    const Poses &pa = there.a, &pb = there.b;
    const V3 delta =
        (there.shift + centre_of(b, pb, there.scale_b)) - centre_of(a, pa, there.scale_a);
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) axes[i][j] = dot(pb.column[i], pa.column[j]);
    const V one = hn::Set(d, 1.0f);
    const V per_a = hn::Div(one, there.scale_a), per_b = hn::Div(one, there.scale_b);
    b_over_a = hn::Mul(there.scale_b, per_a);
    a_over_b = hn::Mul(there.scale_a, per_b);
    offset_a = in_units(
        a,
        V3{dot(pa.column[0], delta), dot(pa.column[1], delta), dot(pa.column[2], delta)} * per_a);
    offset_b = in_units(b, V3{hn::Neg(dot(pb.column[0], delta)), hn::Neg(dot(pb.column[1], delta)),
                              hn::Neg(dot(pb.column[2], delta))} *
                               per_b);
    margin_a = hn::Mul(there.margin, per_a);
    margin_b = hn::Mul(there.margin, per_b);
  }

  /// Calls visit(row number, register) for all members above.
  template <typename Visit>
  HWY_INLINE void each_row(const Visit& visit) {
    for (size_t i = 0; i < 9; ++i) visit(i, axes[i / 3][i % 3]);
    visit(9, offset_a.x), visit(10, offset_a.y), visit(11, offset_a.z);
    visit(12, offset_b.x), visit(13, offset_b.y), visit(14, offset_b.z);
    visit(15, margin_a), visit(16, margin_b), visit(17, b_over_a), visit(18, a_over_b);
  }

  template <int K>
  HWY_INLINE HalfTest<K> from_a(const OrdopTable& a, const OrdopTable& b) const {
    const OrdopTable::Ratios ratio = b.ratios_to(a);
    const auto column = [&](size_t j) HWY_ATTR {
      return V3{scaled_axis(axes[0][j], b_over_a, ratio.of[0][j]),
                scaled_axis(axes[1][j], b_over_a, ratio.of[1][j]),
                scaled_axis(axes[2][j], b_over_a, ratio.of[2][j])};
    };
    return {a, b, {column(0), column(1), column(2)}, offset_a, margin_a};
  }
  template <int K>
  HWY_INLINE HalfTest<K> from_b(const OrdopTable& a, const OrdopTable& b) const {
    const OrdopTable::Ratios ratio = a.ratios_to(b);
    const auto column = [&](size_t j) HWY_ATTR {
      return V3{scaled_axis(axes[j][0], a_over_b, ratio.of[0][j]),
                scaled_axis(axes[j][1], a_over_b, ratio.of[1][j]),
                scaled_axis(axes[j][2], a_over_b, ratio.of[2][j])};
    };
    return {b, a, {column(0), column(1), column(2)}, offset_b, margin_b};
  }

 private:
  static HWY_INLINE V scaled_axis(V axis, V scales, float ratio) {
    return hn::Mul(hn::Mul(axis, scales), hn::Set(Lanes(), ratio));
  }
  static HWY_INLINE V3 in_units(const OrdopTable& own, const V3& v) {
    const Lanes d;
    return {hn::Mul(v.x, hn::Set(d, own.per_half_box[0])),
            hn::Mul(v.y, hn::Set(d, own.per_half_box[1])),
            hn::Mul(v.z, hn::Set(d, own.per_half_box[2]))};
  }
};

/// Candidates of a chunk that the box directions leave undecided, and their data. The box
/// directions separate three quarters of all separable pairs.
template <typename Kept>
struct Undecided {
  HWY_ALIGN float rows[Kept::kRows][kChunk + kLanes];
  HWY_ALIGN uint32_t index[kChunk + kLanes];
  size_t count = 0;

  HWY_INLINE void add(Kept& kept, const uint32_t* order, M left) {
    const Lanes d;
    const LaneBits bits;
    const size_t end = count;  // a register, because the stores might alias `count`
    const Packing packed(left);
    // Whole registers: a masked store costs several times as much.
    kept.each_row([&](size_t row, V v) HWY_ATTR { hn::StoreU(packed(v), d, rows[row] + end); });
    hn::StoreU(packed(hn::LoadU(bits, order)), bits, index + end);
    count = end + hn::CountTrue(d, left);
  }
  HWY_INLINE Kept at(size_t first) const {
    const Lanes d;
    Kept kept;
    kept.each_row([&](size_t row, V& v) { v = hn::Load(d, rows[row] + first); });
    return kept;
  }
};

template <int K>
HWY_INLINE M apart_by_the_rest(const HalfTest<K>& from_a, const HalfTest<K>& from_b) {
  if constexpr (K == 14) return hn::Or(from_a.corners(), from_b.corners());
  const M by_edges = hn::Or(from_a.edges(), from_b.edges());
  if constexpr (K == 18) return by_edges;
  if (hn::AllTrue(Lanes(), by_edges)) return by_edges;
  return hn::Or(by_edges, hn::Or(from_a.corners(), from_b.corners()));
}

template <int K>
HWY_NOINLINE void ordop_pairs(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                              const PartPose* poses, const Candidate* candidates,
                              const uint32_t* order, size_t count, uint8_t* overlaps) {
  const Lanes d;
  const LaneBits bits;
  for (size_t chunk = 0; chunk < count; chunk += kChunk, order += kChunk) {
    const size_t in_chunk = HWY_MIN(count - chunk, kChunk);
    const ChunkInput input(pairs, candidates, order, in_chunk);
    Undecided<Relative> undecided;
    for (size_t first = 0; first < in_chunk; first += kLanes) {
      Relative relative(a, b, PairLanes(poses, input, first));
      const HalfTest<K> from_a = relative.from_a<K>(a, b), from_b = relative.from_b<K>(a, b);
      const M apart = hn::Or(from_a.axes(), from_b.axes());
      const M together = hn::AndNot(apart, share_a_point(from_a, from_b));
      const size_t in_use = HWY_MIN(kLanes, in_chunk - first);
      const M used = hn::RebindMask(d, hn::FirstN(bits, in_use));
      undecided.add(relative, input.order + first, hn::AndNot(hn::Or(apart, together), used));
      const uint32_t decided = bits_of(together);
      for (size_t lane = 0; lane < in_use; ++lane)
        overlaps[input.order[first + lane]] = (decided >> lane) & 1;
    }
    for (size_t first = 0; first < undecided.count; first += kLanes) {
      const Relative relative = undecided.at(first);
      const uint32_t apart =
          bits_of(apart_by_the_rest<K>(relative.from_a<K>(a, b), relative.from_b<K>(a, b)));
      const size_t in_use = HWY_MIN(kLanes, undecided.count - first);
      for (size_t lane = 0; lane < in_use; ++lane)
        overlaps[undecided.index[first + lane]] = ((apart >> lane) & 1) ^ 1;
    }
  }
}

// One or-DOP against another with Highway, compiled once per target: directions as lanes.

/// True if a direction of own separates. The operations are those of the scalar reference.
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

// Distance bounds with Highway, compiled once per target: pairs of the same part shapes as lanes.

/// Largest gap of two or-DOPs along directions of own.
struct Gap {
  V widest;         ///< divided by own's scale; below 0 if no direction separates
  V beyond_margin;  ///< above 0 if a direction separates, see HalfTest::separates()
};
template <typename Each>
HWY_INLINE Gap gap_along(const HalfTest<26>& half, const Each& each) {
  const Lanes tag;
  Gap max_gap = {hn::Set(tag, -kEmptyLow), hn::Set(tag, -kEmptyLow)};
  each(half, [&](size_t index, const V3& d, V tau) HWY_ATTR {
    const auto [apart, reach] = half.along(index, d, tau);
    const V gap = hn::Mul(hn::Sub(apart, reach), hn::Set(tag, half.own.per_length[index]));
    max_gap.widest = hn::Max(max_gap.widest, gap);
    max_gap.beyond_margin =
        hn::Max(max_gap.beyond_margin, hn::Sub(apart, half.with_margin(index, reach)));
  });
  return max_gap;
}

/// Relative pose of part b to part a for distances of points, with the bounds so far.
struct PointLanes {
  static constexpr size_t kRows = 17;
  V axes[3][3];  ///< [i][j]: axis i of b . axis j of a
  V3 root;       ///< from root of a to root of b, in a's frame
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

/// Relative pose of two parts for their gap.
struct GapLanes {
  static constexpr size_t kRows = Relative::kRows + 8;
  Relative relative;
  V3 root;  ///< from root of a to root of b, in a's frame
  V scale_a, scale_b, margin;
  V widest, beyond_margin;  ///< maxima of the gaps so far

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

  /// Includes gaps along some directions of both.
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

/// Point of the part near `to`, in its frame.
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

/// Distance of a point on a from one on b. Looks up three points: from b's middle on a, b, a.
HWY_INLINE V point_to_point(const NearbyPoints& on_a, const NearbyPoints& on_b,
                            const OrdopTable& table_b, const PointLanes& there) {
  const Lanes tag;
  const V one = hn::Set(tag, 1.0f);
  const V per_a = hn::Div(one, there.scale_a), per_b = hn::Div(one, there.scale_b);
  const V3& root = there.root;
  const auto& axes = there.axes;
  const auto from_a = [&](const V3& b) HWY_ATTR {  // in metres, not yet divided by a's scale
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

/// Tests the box directions, then the other directions, then points. Each stage runs on the
/// candidates still within margin_m, packed into full registers.
HWY_NOINLINE void ordop_gaps(const OrdopTable& a, const OrdopTable& b, const NearbyPoints& on_a,
                             const NearbyPoints& on_b, const BodyPair* pairs, const PartPose* poses,
                             const Candidate* candidates, const uint32_t* order, size_t count,
                             float margin_m, GapBounds* bounds, uint8_t* overlaps) {
  const Lanes d;
  const LaneBits bits;
  const V within = hn::Set(d, margin_m);
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
