// kernels_lanes-inl.h defines vectors and poses per lane for the culling kernels. Compiled once per
// target; included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_LANES_INL_H_
#undef THRONG_CULLING_KERNELS_LANES_INL_H_
#else
#define THRONG_CULLING_KERNELS_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "base/simd/lanes-inl.h"
#include "culling/kernels/kernels.h"

#if THRONG_HAS_LANES  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {

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

/// Pose of one part per lane: rotation by columns (the part's axes in the world) and translation.
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

/// Rotates a vector; rows are summed x, y, z.
HWY_INLINE V3 rotated(const Poses& p, const V3& v) {
  const V3 row_x = {p.column[0].x, p.column[1].x, p.column[2].x};
  const V3 row_y = {p.column[0].y, p.column[1].y, p.column[2].y};
  const V3 row_z = {p.column[0].z, p.column[1].z, p.column[2].z};
  return {dot(row_x, v), dot(row_y, v), dot(row_z, v)};
}
HWY_INLINE V3 operator*(const V3& v, V factor) {
  return {hn::Mul(v.x, factor), hn::Mul(v.y, factor), hn::Mul(v.z, factor)};
}

// Slabs::bound with Highway, compiled once per target: a direction per lane, the same or-DOP.

/// table[index] in every lane, index from 0 to 7.
HWY_INLINE V lookup8(const float* HWY_RESTRICT table, U index) {
  const Lanes d;
  if constexpr (kLanes == 4) {
    // Looks up two halves of four and selects: SSE4 has no lookup in eight floats.
    const LaneBits du;
    const auto in_half = hn::IndicesFromVec(d, hn::And(index, hn::Set(du, 3)));
    const V low = hn::TableLookupLanes(hn::Load(d, table), in_half);
    const V high = hn::TableLookupLanes(hn::Load(d, table + 4), in_half);
    const auto upper = hn::Eq(hn::And(index, hn::Set(du, 4)), hn::Set(du, 4));
    return hn::IfThenElse(hn::RebindMask(d, upper), high, low);
  } else {
    return hn::TableLookupLanes(hn::LoadU(d, table), hn::IndicesFromVec(d, index));
  }
}

/// Centre and half width of an or-DOP along the direction of each lane.
struct Interval {
  V centre, half;
};

/// Components of a direction by size, and their axes.
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
  const U y_sign = hn::ShiftRight<30>(hn::BitCast(bits, d.y));
  const U z_sign = hn::ShiftRight<29>(hn::BitCast(bits, d.z));
  s.signs = hn::OrAnd(hn::OrAnd(x_sign, y_sign, hn::Set(bits, 2)), z_sign, hn::Set(bits, 4));
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
  return {lookup8(t.edge_centre + axis * 8, signs), lookup8(t.edge_half + axis * 8, signs)};
}

/// Slab of the edge without the axis of the smallest component.
HWY_INLINE Interval edge_without_smallest(const OrdopTable& t, const Sorted& s) {
#if HWY_TARGET <= HWY_AVX3
  // One lookup in two registers, which Highway 1.0 does not provide.
  const LaneBits bits;
  const auto y_or_x = hn::IfThenElseZero(hn::RebindMask(bits, s.smallest_is_y), hn::Set(bits, 8));
  const auto index = hn::Or(
      s.signs, hn::IfThenElse(hn::RebindMask(bits, s.smallest_is_z), hn::Set(bits, 16), y_or_x));
  const auto lookup = [&](const float* table) {
    return V{_mm512_permutex2var_ps(_mm512_load_ps(table), index.raw, _mm512_load_ps(table + 16))};
  };
  return {lookup(t.edge_centre), lookup(t.edge_half)};
#else
  const Interval x = edge_without(t, 0, s.signs), y = edge_without(t, 1, s.signs),
                 z = edge_without(t, 2, s.signs);
  return {by_smallest(s, x.centre, y.centre, z.centre), by_smallest(s, x.half, y.half, z.half)};
#endif
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

/// Half widths of an or-DOP along its three axes. They are equal in units of the part's box, which
/// avoids a lookup for the largest component.
enum class AxisSlabs { kEqual, kDiffer };

/// Slabs::bound<K> in every lane, by the same operations in the same order.
template <int K, AxisSlabs kAxisSlabs = AxisSlabs::kEqual>
HWY_INLINE Interval bound(const OrdopTable& t, const V3& d) {
  const Lanes tag;
  const Sorted s = sorted(d);
  const AxisHalves axes = axis_halves(t);
  const V largest_half =
      kAxisSlabs == AxisSlabs::kEqual ? axes.x : by_largest(s, axes.x, axes.y, axes.z);
  if constexpr (K == 26) {
    const Interval edge = edge_without_smallest(t, s);
    const Interval corner = {lookup8(t.corner_centre, s.signs), lookup8(t.corner_half, s.signs)};
    return with_axis(scaled(corner, s.smallest) + scaled(edge, hn::Sub(s.middle, s.smallest)),
                     largest_half, hn::Sub(s.largest, s.middle));
  } else if constexpr (K == 18) {
    const Interval e[3] = {edge_without(t, 0, s.signs), edge_without(t, 1, s.signs),
                           edge_without(t, 2, s.signs)};
    const auto pick = [&](V x, V y, V z, int rank) {  // edge without the axis of that rank
      if (rank == 0) return by_largest(s, x, y, z);
      if (rank == 2) return by_smallest(s, x, y, z);
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
    // Corner with the sign of the smallest component flipped.
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

/// Origin of a table's slabs, relative to the body's root.
HWY_INLINE V3 centre_of(const OrdopTable& t, const Poses& pose, V scale) {
  const Lanes d;
  const V3 origin = {hn::Mul(scale, hn::Set(d, t.origin[0])),
                     hn::Mul(scale, hn::Set(d, t.origin[1])),
                     hn::Mul(scale, hn::Set(d, t.origin[2]))};
  return pose.translation + rotated(pose, origin);
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // THRONG_HAS_LANES

#endif  // per-target include guard
