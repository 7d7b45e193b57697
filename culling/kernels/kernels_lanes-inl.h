// Registers of the culling kernels with Highway, compiled once a target: vectors and poses a lane.
// Included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_LANES_INL_H_
#undef THRONG_CULLING_KERNELS_LANES_INL_H_
#else
#define THRONG_CULLING_KERNELS_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>

#include "culling/kernels/kernels.h"

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

/// first, first + 1, ... Highway's Iota writes the lanes to memory one by one and waits for them.
HWY_INLINE U counting_from(uint32_t first) {
  HWY_ALIGN static constexpr uint32_t kCount[] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                  8, 9, 10, 11, 12, 13, 14, 15};
  const LaneBits d;
  return hn::Add(hn::Set(d, first), hn::Load(d, kCount));
}

/// The lanes of a mask as bits of an integer.
HWY_INLINE uint32_t bits_of(M mask) {
  const Lanes d;
  static_assert(std::endian::native == std::endian::little);
  uint32_t bits = 0;
  hn::StoreMaskBits(d, mask, reinterpret_cast<uint8_t*>(&bits));
  return bits;
}

/// (a.x * b.x + a.y * b.y) + a.z * b.z, never fused: the same bits on every target.
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
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

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // HWY_SCALAR

#endif  // per-target include guard
