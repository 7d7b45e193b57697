// Registers of floats with Highway, compiled once a target, and what all fast paths do with them.
// Included after <hwy/foreach_target.h>, by sources that include base/simd/dispatch.h first.
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

#include "base/elementary.h"
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

/// Byte order[mask] of the lanes of each mask: those in the mask first, in order, then lane 0.
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
/// hn::Compress is for AVX-512 only: elsewhere g++ 12 copies the table of Highway 1.0.3 to the
/// stack at every call, which costs more than the kernel around it.
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

/// Four floats each of rows first, first + 4, ... side by side; row(lane) points to them.
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

/// Rows of four floats, one a lane: out[c] gets component c of every lane's row.
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

/// bilinear() of the floats from `from` on, as many as D has lanes.
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

#endif  // per-target include guard
