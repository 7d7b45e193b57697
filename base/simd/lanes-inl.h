// Lanes: registers of floats with Highway and their common operations, compiled once per target.
// Kernels written over lanes use register_pairs or eight_lanes. Included after
// <hwy/foreach_target.h>, by sources that include base/simd/dispatch.h first.
#if defined(THRONG_BASE_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_BASE_SIMD_LANES_INL_H_
#undef THRONG_BASE_SIMD_LANES_INL_H_
#else
#define THRONG_BASE_SIMD_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>

#include "base/portable_math.h"
#include "base/simd/dispatch.h"

#if THRONG_HAS_LANES
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, 16>;
using LaneBits = hn::RebindToUnsigned<Lanes>;
using V = hn::Vec<Lanes>;
using U = hn::Vec<LaneBits>;
using M = hn::Mask<Lanes>;
inline constexpr size_t kLanes = hn::MaxLanes(Lanes());
static_assert(kLanes % 4 == 0);

/// first, first + 1, ... Highway's Iota stores the lanes one by one and stalls on the reload.
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

/// Byte order[mask] of the lanes of each mask: lanes in the mask first, in order, then lane 0.
/// kBytes per lane: 1 for indices of lanes, 4 for indices of bytes.
template <size_t kLaneCount, size_t kBytes>
struct PackingOrders {
  constexpr PackingOrders() {
    for (size_t mask = 0; mask < size_t{1} << kLaneCount; ++mask) {
      size_t packed = 0;
      for (size_t lane = 0; lane < kLaneCount; ++lane) {
        if (((mask >> lane) & 1) == 0) continue;
        for (size_t byte = 0; byte < kBytes; ++byte)
          order[mask][packed++] = static_cast<uint8_t>(lane * kBytes + byte);
      }
    }
  }
  alignas(16) uint8_t order[size_t{1} << kLaneCount][kLaneCount * kBytes] = {};
};

/// Moves the lanes of a mask to the front of registers, in order; the other lanes are unspecified.
/// Replaces hn::Compress, which is fast on AVX-512 only. Elsewhere g++ 12 copies the table of
/// Highway 1.0.3 to the stack at every call, which costs more than the kernel around it.
class Packing {
 public:
#if HWY_TARGET <= HWY_AVX3
  HWY_INLINE explicit Packing(M mask) : mask_(mask) {}
  template <class W>
  HWY_INLINE W operator()(W v) const {
    return hn::Compress(v, hn::RebindMask(hn::DFromV<W>(), mask_));
  }

 private:
  M mask_;
#elif HWY_TARGET == HWY_AVX2
  HWY_INLINE explicit Packing(M mask)
      : order_(hn::PromoteTo(
            LaneBits(), hn::Load(hn::Rebind<uint8_t, Lanes>(), kOrders.order[bits_of(mask)]))) {}
  template <class W>
  HWY_INLINE W operator()(W v) const {
    return hn::TableLookupLanes(v, hn::IndicesFromVec(hn::DFromV<W>(), order_));
  }

 private:
  static constexpr PackingOrders<kLanes, 1> kOrders = {};
  U order_;
#else
  HWY_INLINE explicit Packing(M mask) : order_(hn::Load(Bytes(), kOrders.order[bits_of(mask)])) {}
  template <class W>
  HWY_INLINE W operator()(W v) const {
    return hn::BitCast(hn::DFromV<W>(), hn::TableLookupBytes(hn::BitCast(Bytes(), v), order_));
  }

 private:
  using Bytes = hn::Repartition<uint8_t, Lanes>;
  static constexpr PackingOrders<kLanes, 4> kOrders = {};
  hn::Vec<Bytes> order_;
#endif
};

/// Transposes the 4 x 4 matrices in each group of four lanes.
template <class W>
HWY_INLINE void transpose4(const W (&in)[4], W (&out)[4]) {
  const hn::DFromV<W> d;
  const hn::RepartitionToWide<hn::DFromV<W>> wide;
  const auto pair = [&](W v) { return hn::BitCast(wide, v); };
  const W low01 = hn::InterleaveLower(d, in[0], in[1]),
          high01 = hn::InterleaveUpper(d, in[0], in[1]);
  const W low23 = hn::InterleaveLower(d, in[2], in[3]),
          high23 = hn::InterleaveUpper(d, in[2], in[3]);
  out[0] = hn::BitCast(d, hn::InterleaveLower(wide, pair(low01), pair(low23)));
  out[1] = hn::BitCast(d, hn::InterleaveUpper(wide, pair(low01), pair(low23)));
  out[2] = hn::BitCast(d, hn::InterleaveLower(wide, pair(high01), pair(high23)));
  out[3] = hn::BitCast(d, hn::InterleaveUpper(wide, pair(high01), pair(high23)));
}

/// Loads four floats of each of the rows first, first + 4, ...; row(lane) points to them.
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

/// Rows of four floats, one per lane: out[c] gets component c of every lane's row.
template <typename Row, class W>
HWY_INLINE void load_rows(const Row& row, W (&out)[4]) {
  W rows[4];
  for (size_t i = 0; i < 4; ++i) rows[i] = load_quads(hn::DFromV<W>(), row, i);
  transpose4(rows, out);
}
template <typename Row>
HWY_INLINE void store_rows(const V (&in)[4], const Row& row) {
  V rows[4];
  transpose4(in, rows);
  for (size_t i = 0; i < 4; ++i) store_quads(Lanes(), rows[i], row, i);
}

/// bilinear() of the floats from `from` on, one per lane of D.
template <class D>
HWY_INLINE void store_bilinear(D d, const float* from, size_t next, size_t step, float u, float v,
                               float* to) {
  const auto between = [d](auto low, auto high, auto share) {
    return hn::Add(low, hn::Mul(share, hn::Sub(high, low)));
  };
  const auto along = hn::Set(d, u), across = hn::Set(d, v);
  const auto slow = between(hn::LoadU(d, from), hn::LoadU(d, from + next), along);
  const auto fast = between(hn::LoadU(d, from + step), hn::LoadU(d, from + step + next), along);
  hn::StoreU(between(slow, fast, across), d, to);
}

/// float_sin_cos() of every lane.
HWY_INLINE void float_sin_cos(V angle_rad, V& sin, V& cos) {
  using K = FloatSinCosConstants;
  const Lanes d;
  const LaneBits bits;
  const V rounded = hn::Add(hn::Mul(angle_rad, hn::Set(d, K::kOneOverPi)), hn::Set(d, K::kRound));
  const V n = hn::Sub(rounded, hn::Set(d, K::kRound));
  const V sign = hn::BitCast(d, hn::ShiftLeft<31>(hn::BitCast(bits, rounded)));
  const V r = hn::Sub(hn::Sub(angle_rad, hn::Mul(n, hn::Set(d, K::kPiHigh))),
                      hn::Mul(n, hn::Set(d, K::kPiLow)));
  const V z = hn::Mul(r, r);
  V s = hn::Set(d, K::kSin[3]);
  s = hn::Add(hn::Mul(s, z), hn::Set(d, K::kSin[2]));
  s = hn::Add(hn::Mul(s, z), hn::Set(d, K::kSin[1]));
  s = hn::Add(hn::Mul(s, z), hn::Set(d, K::kSin[0]));
  s = hn::Add(r, hn::Mul(hn::Mul(r, z), s));
  V c = hn::Set(d, K::kCos[4]);
  c = hn::Add(hn::Mul(c, z), hn::Set(d, K::kCos[3]));
  c = hn::Add(hn::Mul(c, z), hn::Set(d, K::kCos[2]));
  c = hn::Add(hn::Mul(c, z), hn::Set(d, K::kCos[1]));
  c = hn::Add(hn::Mul(c, z), hn::Set(d, K::kCos[0]));
  c = hn::Add(hn::Set(d, 1.0f), hn::Mul(z, c));
  sin = hn::Xor(s, sign);
  cos = hn::Xor(c, sign);
}

}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // THRONG_HAS_LANES

/// Prefix of the functions of a kernel written over lanes.
#undef THRONG_LANES
#define THRONG_LANES HWY_INLINE

#if THRONG_HAS_LANES  // the reference is scalar_lanes.h
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE::register_pairs {

/// Two registers at a time. A kernel is one long chain of dependent operations; two independent
/// chains take hardly longer than one.
inline constexpr size_t kLaneCount = 2 * kLanes;

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

/// out[c]: component c of each lane's row of four; row(lane) points to the row.
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

/// Interpolates rows of kFloats (a multiple of four): first(lane), the next row by u, and both
/// `step` farther on by v. Blends rows in place, then transposes.
template <size_t kFloats, typename Row>
HWY_INLINE void blend_rows(const Row& first, size_t step, F u, F v, F (&out)[kFloats]) {
  alignas(64) float us[kLaneCount], vs[kLaneCount], rows[kLaneCount * kFloats];
  store(u, us);
  store(v, vs);
  const hn::CappedTag<float, 4> quad;
  for (size_t lane = 0; lane < kLaneCount; ++lane) {
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

/// Namespace of eight lanes, for kernels with too few numbers to fill more.
#undef THRONG_EIGHT_LANES
#if HWY_MAX_BYTES == 16
#define THRONG_EIGHT_LANES register_pairs
#else
#define THRONG_EIGHT_LANES eight_lanes

#if THRONG_HAS_LANES
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE::eight_lanes {

using Eight = hn::CappedTag<float, 8>;
inline constexpr size_t kLaneCount = hn::MaxLanes(Eight());
static_assert(kLaneCount == 8);

struct F {
  hn::Vec<Eight> v;
  F() = default;
  HWY_INLINE F(hn::Vec<Eight> lanes) : v(lanes) {}
  HWY_INLINE F(float value) : v(hn::Set(Eight(), value)) {}
};
struct M {
  hn::Mask<Eight> v;
};

HWY_INLINE F operator+(F x, F y) { return hn::Add(x.v, y.v); }
HWY_INLINE F operator-(F x, F y) { return hn::Sub(x.v, y.v); }
HWY_INLINE F operator*(F x, F y) { return hn::Mul(x.v, y.v); }
HWY_INLINE F operator/(F x, F y) { return hn::Div(x.v, y.v); }
HWY_INLINE M operator<(F x, F y) { return {hn::Lt(x.v, y.v)}; }
HWY_INLINE M operator<=(F x, F y) { return {hn::Le(x.v, y.v)}; }
HWY_INLINE M operator>(F x, F y) { return {hn::Gt(x.v, y.v)}; }
HWY_INLINE M operator>=(F x, F y) { return {hn::Ge(x.v, y.v)}; }
HWY_INLINE M operator&(M x, M y) { return {hn::And(x.v, y.v)}; }
HWY_INLINE M operator|(M x, M y) { return {hn::Or(x.v, y.v)}; }
HWY_INLINE M operator!(M x) { return {hn::Not(x.v)}; }
HWY_INLINE bool any(M x) { return !hn::AllFalse(Eight(), x.v); }
HWY_INLINE F select(M mask, F yes, F no) { return hn::IfThenElse(mask.v, yes.v, no.v); }
HWY_INLINE F max_of(F x, F y) { return hn::Max(x.v, y.v); }
HWY_INLINE F min_of(F x, F y) { return hn::Min(x.v, y.v); }
HWY_INLINE F abs_of(F x) { return hn::Abs(x.v); }
HWY_INLINE F sqrt_of(F x) { return hn::Sqrt(x.v); }
HWY_INLINE F floor_of(F x) { return hn::Floor(x.v); }
HWY_INLINE F load(const float* from) { return hn::LoadU(Eight(), from); }
HWY_INLINE void store(F x, float* to) { hn::StoreU(x.v, Eight(), to); }
HWY_INLINE void store_whole(F x, int32_t* to) {
  const hn::RebindToSigned<Eight> whole;
  hn::StoreU(hn::ConvertTo(whole, x.v), whole, to);
}

/// out[c]: component c of each lane's row of four; row(lane) points to the row.
template <typename Row>
HWY_INLINE void load_rows(const Row& row, F (&out)[4]) {
  hn::Vec<Eight> lanes[4];
  HWY_NAMESPACE::load_rows(row, lanes);
  for (size_t i = 0; i < 4; ++i) out[i] = lanes[i];
}

}  // namespace throng::HWY_NAMESPACE::eight_lanes
HWY_AFTER_NAMESPACE();
#endif
#endif

#endif  // per-target include guard
