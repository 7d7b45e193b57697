// Scalar lanes: one lane per kernel call, the scalar reference of kernels written over lanes.
// Invariant: every function does what the vector versions in lanes-inl.h do to each lane.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

/// Prefix of the functions of such a kernel.
#define THRONG_LANES inline

namespace throng {

/// Bilinear interpolation in a table: *from and the float `next` farther on by u, the same two
/// `step` farther on by v. Operation for operation as store_bilinear() of lanes-inl.h.
inline float bilinear(const float* from, size_t next, size_t step, float u, float v) {
  const float slow = from[0] + u * (from[next] - from[0]);
  const float fast = from[step] + u * (from[step + next] - from[step]);
  return slow + v * (fast - slow);
}

}  // namespace throng

namespace throng::scalar_lanes {

inline constexpr size_t kLaneCount = 1;

struct F {
  float v = 0;
  F() = default;
  F(float value) : v(value) {}  // NOLINT(google-explicit-constructor): numbers are lanes
};
struct M {
  bool v = false;
};

inline F operator+(F a, F b) { return a.v + b.v; }
inline F operator-(F a, F b) { return a.v - b.v; }
inline F operator*(F a, F b) { return a.v * b.v; }
inline F operator/(F a, F b) { return a.v / b.v; }
inline M operator<(F a, F b) { return {a.v < b.v}; }
inline M operator<=(F a, F b) { return {a.v <= b.v}; }
inline M operator>(F a, F b) { return {a.v > b.v}; }
inline M operator>=(F a, F b) { return {a.v >= b.v}; }
inline M operator&(M a, M b) { return {a.v && b.v}; }
inline M operator|(M a, M b) { return {a.v || b.v}; }
inline M operator!(M a) { return {!a.v}; }
inline bool any(M a) { return a.v; }
inline F select(M mask, F yes, F no) { return mask.v ? yes : no; }
// Returns the second if neither is larger, as vector instructions do.
inline F max_of(F a, F b) { return a.v > b.v ? a : b; }
inline F min_of(F a, F b) { return a.v < b.v ? a : b; }
inline F abs_of(F a) { return std::abs(a.v); }
inline F floor_of(F a) { return std::floor(a.v); }
inline F load(const float* from) { return *from; }
inline void store(F a, float* to) { *to = a.v; }
inline F sqrt_of(F a) { return std::sqrt(a.v); }
/// Integer part of a number of at least 0.
inline void store_whole(F a, int32_t* to) { *to = static_cast<int32_t>(a.v); }

/// out[c]: component c of each lane's row of four; row(lane) points to the row.
template <typename Row>
void load_rows(const Row& row, F (&out)[4]) {
  const float* from = row(0);
  for (size_t c = 0; c < 4; ++c) out[c] = from[c];
}
template <typename Row>
void store_rows(const F (&in)[4], const Row& row) {
  float* to = row(0);
  for (size_t c = 0; c < 4; ++c) to[c] = in[c].v;
}

/// Interpolates rows of kFloats: first(lane), the next by u, and both `step` farther on by v.
template <size_t kFloats, typename Row>
void blend_rows(const Row& first, size_t step, F u, F v, F (&out)[kFloats]) {
  const float* from = first(0);
  for (size_t i = 0; i < kFloats; ++i) out[i] = bilinear(from + i, kFloats, step, u.v, v.v);
}

}  // namespace throng::scalar_lanes
