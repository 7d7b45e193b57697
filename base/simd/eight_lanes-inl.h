// Eight lanes with Highway, compiled once a target: for kernels with too few numbers to fill more.
// One rule: what a kernel that is written over lanes is compiled over, see one_lane.h; its
// namespace is THRONG_EIGHT_LANES.
#if defined(THRONG_BASE_SIMD_EIGHT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_BASE_SIMD_EIGHT_LANES_INL_H_
#undef THRONG_BASE_SIMD_EIGHT_LANES_INL_H_
#else
#define THRONG_BASE_SIMD_EIGHT_LANES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "base/simd/lanes-inl.h"
#include "base/simd/register_pairs-inl.h"

#undef THRONG_EIGHT_LANES
#if HWY_MAX_BYTES == 16
#define THRONG_EIGHT_LANES register_pairs
#else
#define THRONG_EIGHT_LANES eight_lanes

#if THRONG_HAS_LANES
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE::eight_lanes {

using Eight = hn::CappedTag<float, 8>;
inline constexpr size_t kAtOnce = hn::MaxLanes(Eight());
static_assert(kAtOnce == 8);

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

/// out[c]: component c of each lane's row of four; row(lane) points to it.
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
