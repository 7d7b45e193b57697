// The lanes of two vector registers, with Highway, compiled once a target: what a kernel that is
// written over lanes is compiled over.
#if defined(THRONG_BASE_SIMD_REGISTER_PAIRS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_BASE_SIMD_REGISTER_PAIRS_INL_H_
#undef THRONG_BASE_SIMD_REGISTER_PAIRS_INL_H_
#else
#define THRONG_BASE_SIMD_REGISTER_PAIRS_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "base/simd/lanes-inl.h"

/// What functions of such a kernel begin with.
#undef THRONG_LANES
#define THRONG_LANES HWY_INLINE

#if THRONG_HAS_LANES  // the reference is one_lane.h
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE::register_pairs {

/// Two registers at a time: such a kernel is one long chain of sums and products, each waiting for
/// the one before, and two chains take hardly longer than one.
inline constexpr size_t kAtOnce = 2 * kLanes;

struct F {
  V a, b;
  F() = default;
  HWY_INLINE F(V first, V second) : a(first), b(second) {}
  HWY_INLINE F(float value) : a(hn::Set(Lanes(), value)), b(a) {}
};
struct M {
  hn::Mask<Lanes> a, b;
};

HWY_INLINE F operator+(F x, F y) { return {hn::Add(x.a, y.a), hn::Add(x.b, y.b)}; }
HWY_INLINE F operator-(F x, F y) { return {hn::Sub(x.a, y.a), hn::Sub(x.b, y.b)}; }
HWY_INLINE F operator*(F x, F y) { return {hn::Mul(x.a, y.a), hn::Mul(x.b, y.b)}; }
HWY_INLINE F operator/(F x, F y) { return {hn::Div(x.a, y.a), hn::Div(x.b, y.b)}; }
HWY_INLINE M operator<(F x, F y) { return {hn::Lt(x.a, y.a), hn::Lt(x.b, y.b)}; }
HWY_INLINE M operator<=(F x, F y) { return {hn::Le(x.a, y.a), hn::Le(x.b, y.b)}; }
HWY_INLINE M operator>(F x, F y) { return {hn::Gt(x.a, y.a), hn::Gt(x.b, y.b)}; }
HWY_INLINE M operator>=(F x, F y) { return {hn::Ge(x.a, y.a), hn::Ge(x.b, y.b)}; }
HWY_INLINE M operator&(M x, M y) { return {hn::And(x.a, y.a), hn::And(x.b, y.b)}; }
HWY_INLINE M operator|(M x, M y) { return {hn::Or(x.a, y.a), hn::Or(x.b, y.b)}; }
HWY_INLINE M operator!(M x) { return {hn::Not(x.a), hn::Not(x.b)}; }
HWY_INLINE bool any(M x) { return !hn::AllFalse(Lanes(), hn::Or(x.a, x.b)); }
HWY_INLINE F select(M mask, F yes, F no) {
  return {hn::IfThenElse(mask.a, yes.a, no.a), hn::IfThenElse(mask.b, yes.b, no.b)};
}
HWY_INLINE F max_of(F x, F y) { return {hn::Max(x.a, y.a), hn::Max(x.b, y.b)}; }
HWY_INLINE F min_of(F x, F y) { return {hn::Min(x.a, y.a), hn::Min(x.b, y.b)}; }
HWY_INLINE F abs_of(F x) { return {hn::Abs(x.a), hn::Abs(x.b)}; }
HWY_INLINE F sqrt_of(F x) { return {hn::Sqrt(x.a), hn::Sqrt(x.b)}; }
HWY_INLINE F floor_of(F x) { return {hn::Floor(x.a), hn::Floor(x.b)}; }
HWY_INLINE F load(const float* from) {
  return {hn::LoadU(Lanes(), from), hn::LoadU(Lanes(), from + kLanes)};
}
HWY_INLINE void store(F x, float* to) {
  hn::StoreU(x.a, Lanes(), to);
  hn::StoreU(x.b, Lanes(), to + kLanes);
}
HWY_INLINE void store_whole(F x, int32_t* to) {
  const hn::RebindToSigned<Lanes> whole;
  hn::StoreU(hn::ConvertTo(whole, x.a), whole, to);
  hn::StoreU(hn::ConvertTo(whole, x.b), whole, to + kLanes);
}

/// out[c]: component c of each lane's row of four; row(lane) points to it.
template <typename Row>
HWY_INLINE void load_rows(const Row& row, F (&out)[4]) {
  V a[4], b[4];
  HWY_NAMESPACE::load_rows(row, a);
  HWY_NAMESPACE::load_rows([&row](size_t lane) HWY_ATTR { return row(kLanes + lane); }, b);
  for (size_t i = 0; i < 4; ++i) out[i] = {a[i], b[i]};
}
template <typename Row>
HWY_INLINE void store_rows(const F (&in)[4], const Row& row) {
  const V a[4] = {in[0].a, in[1].a, in[2].a, in[3].a}, b[4] = {in[0].b, in[1].b, in[2].b, in[3].b};
  HWY_NAMESPACE::store_rows(a, row);
  HWY_NAMESPACE::store_rows(b, [&row](size_t lane) HWY_ATTR { return row(kLanes + lane); });
}

/// Between rows of kFloats, a multiple of four: first(lane), the next by u, and both `step` farther
/// on by v. Rows are blended as they lie, then transposed.
template <size_t kFloats, typename Row>
HWY_INLINE void blend_rows(const Row& first, size_t step, F u, F v, F (&out)[kFloats]) {
  alignas(64) float us[kAtOnce], vs[kAtOnce], rows[kAtOnce * kFloats];
  store(u, us);
  store(v, vs);
  const hn::CappedTag<float, 4> quad;
  for (size_t lane = 0; lane < kAtOnce; ++lane) {
    const float* from = first(lane);
    float* to = rows + lane * kFloats;
    size_t i = 0;
    for (; i + kLanes <= kFloats; i += kLanes)
      store_bilinear(Lanes(), from + i, kFloats, step, us[lane], vs[lane], to + i);
    for (; i < kFloats; i += 4)
      store_bilinear(quad, from + i, kFloats, step, us[lane], vs[lane], to + i);
  }
  for (size_t i = 0; i < kFloats; i += 4) {
    F four[4];
    load_rows([&](size_t lane) { return rows + lane * kFloats + i; }, four);
    for (size_t c = 0; c < 4; ++c) out[i + c] = four[c];
  }
}

}  // namespace throng::HWY_NAMESPACE::register_pairs
HWY_AFTER_NAMESPACE();
#endif

#endif  // per-target include guard
