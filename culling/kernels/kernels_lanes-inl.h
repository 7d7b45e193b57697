// What the culling kernels keep in registers, compiled once a target: vectors and poses a lane.
// Included by kernels_simd.cpp only.
#if defined(THRONG_CULLING_KERNELS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CULLING_KERNELS_LANES_INL_H_
#undef THRONG_CULLING_KERNELS_LANES_INL_H_
#else
#define THRONG_CULLING_KERNELS_LANES_INL_H_
#endif

#include "base/simd/lanes-inl.h"
#include "culling/kernels/kernels.h"

#if THRONG_HAS_LANES  // the scalar reference is kernels_scalar.cpp
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {

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
#endif  // THRONG_HAS_LANES

#endif  // per-target include guard
