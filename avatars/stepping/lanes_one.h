// One person as one lane: what walk_lanes-inl.h is compiled over for the scalar reference.
// One rule: every function does what the vector version in lanes_many-inl.h does to each lane.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace throng::one_lane {

inline constexpr size_t kLanes = 1;

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
// The second where neither is the larger: as vector instructions have it.
inline F max_of(F a, F b) { return a.v > b.v ? a : b; }
inline F min_of(F a, F b) { return a.v < b.v ? a : b; }
inline F abs_of(F a) { return std::abs(a.v); }
inline F floor_of(F a) { return std::floor(a.v); }
inline F load(const float* from) { return *from; }
inline void store(F a, float* to) { *to = a.v; }
inline F sqrt_of(F a) { return std::sqrt(a.v); }
/// The whole part of a number from 0.
inline void store_whole(F a, int32_t* to) { *to = static_cast<int32_t>(a.v); }

/// out[c]: component c of each lane's row of four; row(lane) points to it.
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

/// Between rows of kFloats: first(lane), the next by u, and both `step` farther on by v.
template <size_t kFloats, typename Row>
void blend_rows(const Row& first, size_t step, F u, F v, F (&out)[kFloats]) {
  const float* a = first(0);
  const float* b = a + step;
  for (size_t i = 0; i < kFloats; ++i) {
    const float slow = a[i] + u.v * (a[kFloats + i] - a[i]);
    const float fast = b[i] + u.v * (b[kFloats + i] - b[i]);
    out[i] = slow + v.v * (fast - slow);
  }
}

}  // namespace throng::one_lane
