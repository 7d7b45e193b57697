// or-DOP tests and boxes with Highway, compiled once a target: pairs of the same two part shapes
// (or bodies of the same type) as lanes. Included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_ORDOP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_ORDOP_INL_H_
#undef THRONG_CULLING_KERNELS_ORDOP_INL_H_
#else
#define THRONG_CULLING_KERNELS_ORDOP_INL_H_
#endif

#include <hwy/highway.h>

#include "culling/kernels.h"
#include "culling/volumes/directions.h"

#if HWY_TARGET != HWY_SCALAR  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, 16>;
using LaneBits = hn::RebindToUnsigned<Lanes>;
using V = hn::Vec<Lanes>;
using U = hn::Vec<LaneBits>;
using M = hn::Mask<Lanes>;
inline constexpr size_t kLanes = hn::MaxLanes(Lanes());

/// A vector in every lane.
struct V3 {
  V x, y, z;
};

HWY_INLINE V3 operator+(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

/// (a.x * b.x + a.y * b.y) + a.z * b.z, never fused: the same bits on every target.
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

/// table[index] in every lane, index in 0..7.
HWY_INLINE V lookup8(const float* HWY_RESTRICT table, U index) {
  const Lanes d;
  if constexpr (kLanes == 4) {
    // Two halves of four, then choose: SSE4 has no lookup in eight floats.
    const LaneBits du;
    const auto in_half = hn::IndicesFromVec(d, hn::And(index, hn::Set(du, 3)));
    const V low = hn::TableLookupLanes(hn::Load(d, table), in_half);
    const V high = hn::TableLookupLanes(hn::Load(d, table + 4), in_half);
    const auto upper = hn::Eq(hn::And(index, hn::Set(du, 4)), hn::Set(du, 4));
    return hn::IfThenElse(hn::RebindMask(d, upper), high, low);
  } else {
    return hn::TableLookupLanes(hn::Load(d, table), hn::IndicesFromVec(d, index));
  }
}

/// Centre and half width of an or-DOP along a direction that differs from lane to lane.
struct Interval {
  V centre, half;
};

/// A direction's components by size, and where they came from.
struct Sorted {
  V largest, middle, smallest;
  M largest_is_x, largest_is_y, smallest_is_z, smallest_is_y;
  U signs;  // bit 0: x negative, bit 1: y, bit 2: z
};

HWY_INLINE Sorted sorted(const V3& d) {
  const LaneBits bits;
  Sorted s;
  const V x = hn::Abs(d.x), y = hn::Abs(d.y), z = hn::Abs(d.z);
  const V low = hn::Min(x, y), high = hn::Max(x, y);
  s.largest = hn::Max(high, z);
  s.smallest = hn::Min(low, z);
  s.middle = hn::Max(low, hn::Min(high, z));
  s.largest_is_x = hn::Eq(x, s.largest);
  s.largest_is_y = hn::Eq(y, s.largest);
  s.smallest_is_z = hn::Eq(z, s.smallest);
  s.smallest_is_y = hn::Eq(y, s.smallest);
  const U x_sign = hn::ShiftRight<31>(hn::BitCast(bits, d.x));
  const U y_sign = hn::ShiftRight<31>(hn::BitCast(bits, d.y));
  const U z_sign = hn::ShiftRight<31>(hn::BitCast(bits, d.z));
  s.signs = hn::Or(x_sign, hn::Or(hn::ShiftLeft<1>(y_sign), hn::ShiftLeft<2>(z_sign)));
  return s;
}

HWY_INLINE V by_largest(const Sorted& s, V x, V y, V z) {
  return hn::IfThenElse(s.largest_is_x, x, hn::IfThenElse(s.largest_is_y, y, z));
}
HWY_INLINE V by_smallest(const Sorted& s, V x, V y, V z) {
  return hn::IfThenElse(s.smallest_is_z, z, hn::IfThenElse(s.smallest_is_y, y, x));
}

/// Half widths along the axis directions; their centres are zero (see OrdopTable).
struct AxisHalves {
  V x, y, z;
};
HWY_INLINE AxisHalves axis_halves(const OrdopTable& t) {
  const Lanes d;
  return {hn::Set(d, t.slabs.slab[0].half), hn::Set(d, t.slabs.slab[1].half),
          hn::Set(d, t.slabs.slab[2].half)};
}

HWY_INLINE Interval edge_without(const OrdopTable& t, int axis, U signs) {
  return {lookup8(t.edge_centre[axis], signs), lookup8(t.edge_half[axis], signs)};
}

HWY_INLINE Interval scaled(const Interval& i, V weight) {
  return {hn::Mul(weight, i.centre), hn::Mul(weight, i.half)};
}
/// Adds an axis slab, whose centre is zero.
HWY_INLINE Interval with_axis(const Interval& sum, V half, V weight) {
  return {sum.centre, hn::Add(sum.half, hn::Mul(weight, half))};
}
HWY_INLINE Interval operator+(const Interval& a, const Interval& b) {
  return {hn::Add(a.centre, b.centre), hn::Add(a.half, b.half)};
}

/// Slabs::bound<K> in every lane, by the same operations in the same order.
template <int K>
HWY_INLINE Interval bound(const OrdopTable& t, const V3& d) {
  const Lanes tag;
  const Sorted s = sorted(d);
  const AxisHalves axes = axis_halves(t);
  const V largest_half = by_largest(s, axes.x, axes.y, axes.z);
  if constexpr (K == 26) {
    const Interval ex = edge_without(t, 0, s.signs), ey = edge_without(t, 1, s.signs),
                   ez = edge_without(t, 2, s.signs);
    const Interval edge = {by_smallest(s, ex.centre, ey.centre, ez.centre),
                           by_smallest(s, ex.half, ey.half, ez.half)};
    const Interval corner = {lookup8(t.corner_centre, s.signs), lookup8(t.corner_half, s.signs)};
    return with_axis(scaled(corner, s.smallest) + scaled(edge, hn::Sub(s.middle, s.smallest)),
                     largest_half, hn::Sub(s.largest, s.middle));
  } else if constexpr (K == 18) {
    const Interval e[3] = {edge_without(t, 0, s.signs), edge_without(t, 1, s.signs),
                           edge_without(t, 2, s.signs)};
    const auto pick = [&](V x, V y, V z, int rank) {  // the edge without the axis of that rank
      if (rank == 0) return by_largest(s, x, y, z);
      if (rank == 2) return by_smallest(s, x, y, z);
      // The middle axis is the one that is neither.
      const M x_taken = hn::Or(s.largest_is_x, hn::Not(hn::Or(s.smallest_is_z, s.smallest_is_y)));
      const M y_largest = hn::AndNot(s.largest_is_x, s.largest_is_y);
      const M y_smallest = hn::AndNot(s.smallest_is_z, s.smallest_is_y);
      return hn::IfThenElse(x_taken, hn::IfThenElse(hn::Or(y_largest, y_smallest), z, y), x);
    };
    const auto edge = [&](int rank) {
      return Interval{pick(e[0].centre, e[1].centre, e[2].centre, rank),
                      pick(e[0].half, e[1].half, e[2].half, rank)};
    };
    const V zero = hn::Zero(tag), half = hn::Set(tag, 0.5f);
    const V axis_weight = hn::Max(zero, hn::Sub(hn::Sub(s.largest, s.middle), s.smallest));
    const M long_axis = hn::Ge(s.largest, hn::Add(s.middle, s.smallest));
    const auto half_weight = [&](V a, V b, V c) {
      return hn::Max(zero, hn::Mul(half, hn::Sub(hn::Add(a, b), c)));
    };
    const Interval e0 = edge(0), e1 = edge(1), e2 = edge(2);
    const Interval one =
        with_axis(scaled(e2, s.middle) + scaled(e1, s.smallest), largest_half, axis_weight);
    const Interval two = (scaled(e2, half_weight(s.largest, s.middle, s.smallest)) +
                          scaled(e1, half_weight(s.largest, s.smallest, s.middle))) +
                         scaled(e0, half_weight(s.middle, s.smallest, s.largest));
    return {hn::IfThenElse(long_axis, one.centre, two.centre),
            hn::IfThenElse(long_axis, one.half, two.half)};
  } else {
    static_assert(K == 14);
    const LaneBits bits;
    const V half = hn::Set(tag, 0.5f);

    const M x_taken = hn::Or(s.largest_is_x, hn::Not(hn::Or(s.smallest_is_z, s.smallest_is_y)));
    const M y_taken = hn::Or(hn::AndNot(s.largest_is_x, s.largest_is_y),
                             hn::AndNot(s.smallest_is_z, s.smallest_is_y));
    const auto middle_of = [&](V x, V y, V z) {
      return hn::IfThenElse(x_taken, hn::IfThenElse(y_taken, z, y), x);
    };
    const V middle_half = middle_of(axes.x, axes.y, axes.z);
    const Interval corner = {lookup8(t.corner_centre, s.signs), lookup8(t.corner_half, s.signs)};
    // The corner with the sign of the smallest component turned round.
    const M small_y = hn::AndNot(s.smallest_is_z, s.smallest_is_y);
    const V flip_bit = hn::IfThenElse(s.smallest_is_z, hn::BitCast(tag, hn::Set(bits, 4u)),
                                      hn::IfThenElse(small_y, hn::BitCast(tag, hn::Set(bits, 2u)),
                                                     hn::BitCast(tag, hn::Set(bits, 1u))));
    const U flipped = hn::Xor(s.signs, hn::BitCast(bits, flip_bit));
    const Interval corner_flipped = {lookup8(t.corner_centre, flipped),
                                     lookup8(t.corner_half, flipped)};
    const Interval one =
        with_axis(with_axis(scaled(corner, s.smallest), middle_half, hn::Sub(s.middle, s.smallest)),
                  largest_half, hn::Sub(s.largest, s.smallest));
    const Interval two =
        with_axis(scaled(corner, hn::Mul(half, hn::Add(s.middle, s.smallest))) +
                      scaled(corner_flipped, hn::Mul(half, hn::Sub(s.middle, s.smallest))),
                  largest_half, hn::Sub(s.largest, s.middle));
    const V low = hn::Max(hn::Sub(one.centre, one.half), hn::Sub(two.centre, two.half));
    const V high = hn::Min(hn::Add(one.centre, one.half), hn::Add(two.centre, two.half));
    return {hn::Mul(half, hn::Add(low, high)), hn::Mul(half, hn::Sub(high, low))};
  }
}

/// Transposes the 4 x 4 matrices in each group of four lanes.
HWY_INLINE void transpose4(const V (&in)[4], V (&out)[4]) {
  const Lanes d;
  const hn::RepartitionToWide<Lanes> wide;
  const auto pair = [&](V v) { return hn::BitCast(wide, v); };
  const V low01 = hn::InterleaveLower(d, in[0], in[1]),
          high01 = hn::InterleaveUpper(d, in[0], in[1]);
  const V low23 = hn::InterleaveLower(d, in[2], in[3]),
          high23 = hn::InterleaveUpper(d, in[2], in[3]);
  out[0] = hn::BitCast(d, hn::InterleaveLower(wide, pair(low01), pair(low23)));
  out[1] = hn::BitCast(d, hn::InterleaveUpper(wide, pair(low01), pair(low23)));
  out[2] = hn::BitCast(d, hn::InterleaveLower(wide, pair(high01), pair(high23)));
  out[3] = hn::BitCast(d, hn::InterleaveUpper(wide, pair(high01), pair(high23)));
}

/// Rows of four floats, one a lane: out[c] gets component c of every lane's row. Rows 16-byte
/// aligned.
template <typename Row>
HWY_INLINE void load_rows(const Row& row, V (&out)[4]) {
  const Lanes d;
  V r[4];
  for (size_t i = 0; i < 4; ++i) {
    // Lane group g of r[i] is the row of lane 4 g + i.
    if constexpr (kLanes == 4) {
      r[i] = hn::Load(d, row(i));
    } else if constexpr (kLanes == 8) {
      const hn::CappedTag<float, 4> quad;
      r[i] = hn::Combine(d, hn::Load(quad, row(i + 4)), hn::Load(quad, row(i)));
    } else {
      const hn::CappedTag<float, 4> quad;
      const hn::CappedTag<float, 8> oct;
      r[i] =
          hn::Combine(d, hn::Combine(oct, hn::Load(quad, row(i + 12)), hn::Load(quad, row(i + 8))),
                      hn::Combine(oct, hn::Load(quad, row(i + 4)), hn::Load(quad, row(i))));
    }
  }
  transpose4(r, out);
}

/// The poses of one part a lane: rotation by columns (the part's axes in the world) and
/// translation.
struct Poses {
  V3 column[3];
  V3 translation;
};

template <typename PoseOf>
HWY_INLINE Poses load_poses(const PoseOf& pose_of) {
  V rows[3][4];
  for (size_t r = 0; r < 3; ++r)
    load_rows([&](size_t lane) { return pose_of(lane)->rows[r]; }, rows[r]);
  Poses p;
  for (size_t c = 0; c < 3; ++c) p.column[c] = {rows[0][c], rows[1][c], rows[2][c]};
  p.translation = {rows[0][3], rows[1][3], rows[2][3]};
  return p;
}

/// Rotation times vector, rows summed x, y, z.
HWY_INLINE V3 turned(const Poses& p, const V3& v) {
  const V3 row_x = {p.column[0].x, p.column[1].x, p.column[2].x};
  const V3 row_y = {p.column[0].y, p.column[1].y, p.column[2].y};
  const V3 row_z = {p.column[0].z, p.column[1].z, p.column[2].z};
  return {dot(row_x, v), dot(row_y, v), dot(row_z, v)};
}
HWY_INLINE V3 operator*(const V3& v, V factor) {
  return {hn::Mul(v.x, factor), hn::Mul(v.y, factor), hn::Mul(v.z, factor)};
}

/// Where the origin of a table's slabs lies, relative to the body's root.
HWY_INLINE V3 centre_of(const OrdopTable& t, const Poses& pose, V scale) {
  const Lanes d;
  const V3 origin = {hn::Mul(scale, hn::Set(d, t.origin[0])),
                     hn::Mul(scale, hn::Set(d, t.origin[1])),
                     hn::Mul(scale, hn::Set(d, t.origin[2]))};
  return pose.translation + turned(pose, origin);
}

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

/// Lanes whose or-DOPs are apart. Directions go from the ones that separate most to the rest, and
/// the rest is skipped once every lane is decided.
template <int K>
HWY_INLINE M separated(const HalfTest<K>& a, const HalfTest<K>& b) {
  const Lanes d;
  M out = hn::Or(a.axes(), b.axes());
  if (hn::AllTrue(d, out)) return out;
  if constexpr (K != 14) out = hn::Or(out, hn::Or(a.edges(), b.edges()));
  if constexpr (K == 26) {
    if (hn::AllTrue(d, out)) return out;
  }
  if constexpr (K != 18) out = hn::Or(out, hn::Or(a.corners(), b.corners()));
  return out;
}

template <int K>
HWY_NOINLINE void ordop_pairs(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                              const PartPose* poses, const Candidate* candidates,
                              const uint32_t* order, size_t count, uint8_t* overlaps) {
  const Lanes d;
  for (size_t first = 0; first < count; first += kLanes) {
    const size_t in_use = HWY_MIN(kLanes, count - first);
    // Lanes beyond the last candidate repeat it.
    const BodyPair* pair_of[kLanes];
    const PartPose* pose_a[kLanes];
    const PartPose* pose_b[kLanes];
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const Candidate& c = candidates[order[first + HWY_MIN(lane, in_use - 1)]];
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
    V relative[3][3];  // [i][j]: axis i of b . axis j of a
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) relative[i][j] = dot(pb.column[i], pa.column[j]);
    const V one = hn::Set(d, 1.0f);
    const V per_a = hn::Div(one, scales[0]), per_b = hn::Div(one, scales[1]);
    const V b_over_a = hn::Mul(scales[1], per_a), a_over_b = hn::Mul(scales[0], per_b);
    HalfTest<K> from_a{a, b, {}, {}, hn::Mul(shift[3], per_a)};
    HalfTest<K> from_b{b, a, {}, {}, hn::Mul(shift[3], per_b)};
    for (size_t j = 0; j < 3; ++j) {
      from_a.column[j] = V3{relative[0][j], relative[1][j], relative[2][j]} * b_over_a;
      from_b.column[j] = V3{relative[j][0], relative[j][1], relative[j][2]} * a_over_b;
    }
    from_a.offset =
        V3{dot(pa.column[0], delta), dot(pa.column[1], delta), dot(pa.column[2], delta)} * per_a;
    from_b.offset = V3{hn::Neg(dot(pb.column[0], delta)), hn::Neg(dot(pb.column[1], delta)),
                       hn::Neg(dot(pb.column[2], delta))} *
                    per_b;
    const M apart = separated<K>(from_a, from_b);
    HWY_ALIGN float flags[kLanes];
    hn::Store(hn::IfThenElse(apart, hn::Zero(d), hn::Set(d, 1.0f)), d, flags);
    for (size_t lane = 0; lane < in_use; ++lane)
      overlaps[order[first + lane]] = flags[lane] != 0.0f;
  }
}

/// Stores rows of four parts, a body a lane, at `offset` of each body's block.
HWY_INLINE void store_parts(const V (&by_part)[4], float* const* blocks, size_t offset,
                            size_t bodies) {
  V by_body[4];
  transpose4(by_part, by_body);
  const Lanes d;
  const hn::CappedTag<float, 4> quad;
  HWY_ALIGN float rows[4][kLanes];
  for (size_t i = 0; i < 4; ++i) hn::Store(by_body[i], d, rows[i]);
  for (size_t lane = 0; lane < bodies; ++lane)
    hn::Store(hn::Load(quad, &rows[lane % 4][lane / 4 * 4]), quad, blocks[lane] + offset);
}

HWY_NOINLINE void part_boxes(const OrdopTable* tables, size_t parts, const PartPose* poses,
                             const float* scales, const float* margins, size_t bodies,
                             float* const* blocks) {
  const Lanes d;
  const size_t padded = padded_parts(parts);
  const V nothing_low = hn::Set(d, kEmptyLow), nothing_high = hn::Set(d, kEmptyHigh);
  for (size_t first = 0; first < bodies; first += kLanes) {
    const size_t in_use = HWY_MIN(kLanes, bodies - first);
    HWY_ALIGN float scale_of[kLanes], margin_of[kLanes];
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const size_t body = first + HWY_MIN(lane, in_use - 1);
      scale_of[lane] = scales[body];
      margin_of[lane] = margins[body];
    }
    const V scale = hn::Load(d, scale_of), margin = hn::Load(d, margin_of);
    V body_low[3] = {nothing_low, nothing_low, nothing_low};
    V body_high[3] = {nothing_high, nothing_high, nothing_high};
    for (size_t quad = 0; quad < padded; quad += 4) {
      V low[3][4], high[3][4];
      for (size_t p = 0; p < 4; ++p) {
        const size_t part = quad + p;
        if (part >= parts) {
          for (size_t axis = 0; axis < 3; ++axis)
            low[axis][p] = nothing_low, high[axis][p] = nothing_high;
          continue;
        }
        const Poses pose = load_poses([&](size_t lane) {
          return &poses[(first + HWY_MIN(lane, in_use - 1)) * parts + part];
        });
        const V3 origin = centre_of(tables[part], pose, scale);
        const V middle[3] = {origin.x, origin.y, origin.z};
        const V3 direction[3] = {{pose.column[0].x, pose.column[1].x, pose.column[2].x},
                                 {pose.column[0].y, pose.column[1].y, pose.column[2].y},
                                 {pose.column[0].z, pose.column[1].z, pose.column[2].z}};
        for (size_t axis = 0; axis < 3; ++axis) {
          const Interval extent = scaled(bound<26>(tables[part], direction[axis]), scale);
          const V centre = hn::Add(middle[axis], extent.centre);
          const V half = hn::Add(extent.half, margin);
          low[axis][p] = hn::Sub(centre, half);
          high[axis][p] = hn::Add(centre, half);
          body_low[axis] = hn::Min(body_low[axis], low[axis][p]);
          body_high[axis] = hn::Max(body_high[axis], high[axis][p]);
        }
      }
      for (size_t axis = 0; axis < 3; ++axis) {
        store_parts(low[axis], blocks + first, kBoxLanes + axis * padded + quad, in_use);
        store_parts(high[axis], blocks + first, kBoxLanes + (axis + 3) * padded + quad, in_use);
      }
    }
    const V zero = hn::Zero(d);
    store_parts({body_low[0], body_low[1], body_low[2], zero}, blocks + first, 0, in_use);
    store_parts({body_high[0], body_high[1], body_high[2], zero}, blocks + first, 4, in_use);
  }
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // HWY_SCALAR

#endif  // per-target include guard
