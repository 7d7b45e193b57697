// People as the lanes of a vector register, with Highway, compiled once a target.
// Included by walk_simd.cpp only.
#if defined(THRONG_AVATARS_LANES_MANY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_AVATARS_LANES_MANY_INL_H_
#undef THRONG_AVATARS_LANES_MANY_INL_H_
#else
#define THRONG_AVATARS_LANES_MANY_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128  // the reference is lanes_one.h
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;
inline constexpr size_t kRegister = hn::MaxLanes(Tag());
/// Two registers at a time: a walker is one long chain of sums and products, each waiting for the
/// one before, and two chains take hardly longer than one.
inline constexpr size_t kLanes = 2 * kRegister;

struct F {
  V a, b;
  F() = default;
  HWY_INLINE F(V first, V second) : a(first), b(second) {}
  HWY_INLINE F(float value) : a(hn::Set(Tag(), value)), b(a) {}
};
struct M {
  hn::Mask<Tag> a, b;
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
HWY_INLINE bool any(M x) { return !hn::AllFalse(Tag(), hn::Or(x.a, x.b)); }
HWY_INLINE F select(M mask, F yes, F no) {
  return {hn::IfThenElse(mask.a, yes.a, no.a), hn::IfThenElse(mask.b, yes.b, no.b)};
}
HWY_INLINE F max_of(F x, F y) { return {hn::Max(x.a, y.a), hn::Max(x.b, y.b)}; }
HWY_INLINE F min_of(F x, F y) { return {hn::Min(x.a, y.a), hn::Min(x.b, y.b)}; }
HWY_INLINE F abs_of(F x) { return {hn::Abs(x.a), hn::Abs(x.b)}; }
HWY_INLINE F sqrt_of(F x) { return {hn::Sqrt(x.a), hn::Sqrt(x.b)}; }
HWY_INLINE F floor_of(F x) { return {hn::Floor(x.a), hn::Floor(x.b)}; }
HWY_INLINE F load(const float* from) {
  return {hn::LoadU(Tag(), from), hn::LoadU(Tag(), from + kRegister)};
}
HWY_INLINE void store(F x, float* to) {
  hn::StoreU(x.a, Tag(), to);
  hn::StoreU(x.b, Tag(), to + kRegister);
}
HWY_INLINE void store_whole(F x, int32_t* to) {
  const hn::RebindToSigned<Tag> whole;
  hn::StoreU(hn::ConvertTo(whole, x.a), whole, to);
  hn::StoreU(hn::ConvertTo(whole, x.b), whole, to + kRegister);
}

/// Transposes the 4 x 4 matrices in each group of four lanes.
HWY_INLINE void transpose(const V (&in)[4], V (&out)[4]) {
  const Tag d;
  const hn::RepartitionToWide<Tag> wide;
  const auto pair = [&](V v) { return hn::BitCast(wide, v); };
  const auto low01 = pair(hn::InterleaveLower(d, in[0], in[1])),
             high01 = pair(hn::InterleaveUpper(d, in[0], in[1])),
             low23 = pair(hn::InterleaveLower(d, in[2], in[3])),
             high23 = pair(hn::InterleaveUpper(d, in[2], in[3]));
  out[0] = hn::BitCast(d, hn::InterleaveLower(wide, low01, low23));
  out[1] = hn::BitCast(d, hn::InterleaveUpper(wide, low01, low23));
  out[2] = hn::BitCast(d, hn::InterleaveLower(wide, high01, high23));
  out[3] = hn::BitCast(d, hn::InterleaveUpper(wide, high01, high23));
}

/// Rows first, first + 4, ... side by side.
template <class D, typename Row>
HWY_INLINE hn::Vec<D> load_quads(D d, const Row& row, size_t first) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::LoadU(d, row(first));
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, load_quads(half, row, first + hn::MaxLanes(half)),
                       load_quads(half, row, first));
  }
}
template <class D, typename Row>
HWY_INLINE void store_quads(D d, hn::Vec<D> v, const Row& row, size_t first) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    hn::StoreU(v, d, row(first));
  } else {
    const hn::Half<D> half;
    store_quads(half, hn::LowerHalf(half, v), row, first);
    store_quads(half, hn::UpperHalf(half, v), row, first + hn::MaxLanes(half));
  }
}

/// out[c]: component c of each lane's row of four; row(lane) points to it.
template <typename Row>
HWY_INLINE void load_rows(const Row& row, F (&out)[4]) {
  V rows[4], a[4], b[4];
  for (size_t i = 0; i < 4; ++i) rows[i] = load_quads(Tag(), row, i);
  transpose(rows, a);
  for (size_t i = 0; i < 4; ++i) rows[i] = load_quads(Tag(), row, kRegister + i);
  transpose(rows, b);
  for (size_t i = 0; i < 4; ++i) out[i] = {a[i], b[i]};
}
template <typename Row>
HWY_INLINE void store_rows(const F (&in)[4], const Row& row) {
  const V a[4] = {in[0].a, in[1].a, in[2].a, in[3].a}, b[4] = {in[0].b, in[1].b, in[2].b, in[3].b};
  V rows[4];
  transpose(a, rows);
  for (size_t i = 0; i < 4; ++i) store_quads(Tag(), rows[i], row, i);
  transpose(b, rows);
  for (size_t i = 0; i < 4; ++i) store_quads(Tag(), rows[i], row, kRegister + i);
}

template <class D>
HWY_INLINE void blend_at(D d, const float* a, size_t next, size_t step, float u, float v,
                         float* out) {
  const auto between = [d](auto from, auto to, auto share) {
    return hn::Add(from, hn::Mul(share, hn::Sub(to, from)));
  };
  const auto along = hn::Set(d, u), across = hn::Set(d, v);
  const auto slow = between(hn::LoadU(d, a), hn::LoadU(d, a + next), along);
  const auto fast = between(hn::LoadU(d, a + step), hn::LoadU(d, a + step + next), along);
  hn::StoreU(between(slow, fast, across), d, out);
}

/// Between rows of kFloats, a multiple of four: first(lane), the next by u, and both `step` farther
/// on by v. Rows are blended as they lie, then transposed.
template <size_t kFloats, typename Row>
HWY_INLINE void blend_rows(const Row& first, size_t step, F u, F v, F (&out)[kFloats]) {
  alignas(64) float us[kLanes], vs[kLanes], rows[kLanes * kFloats];
  store(u, us);
  store(v, vs);
  const hn::CappedTag<float, 4> quad;
  for (size_t lane = 0; lane < kLanes; ++lane) {
    const float* from = first(lane);
    float* to = rows + lane * kFloats;
    size_t i = 0;
    for (; i + kRegister <= kFloats; i += kRegister)
      blend_at(Tag(), from + i, kFloats, step, us[lane], vs[lane], to + i);
    for (; i < kFloats; i += 4) blend_at(quad, from + i, kFloats, step, us[lane], vs[lane], to + i);
  }
  for (size_t i = 0; i < kFloats; i += 4) {
    F four[4];
    load_rows([&](size_t lane) { return rows + lane * kFloats + i; }, four);
    for (size_t c = 0; c < 4; ++c) out[i + c] = four[c];
  }
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#endif  // per-target include guard
