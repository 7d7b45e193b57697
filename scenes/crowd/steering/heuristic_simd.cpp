// Eight ways at a time: heuristic-inl.h over vector registers.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.h"
#include "base/simd/dispatch.h"
#include "scenes/crowd/steering/heuristic.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scenes/crowd/steering/heuristic_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/eight_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace THRONG_EIGHT_LANES {
namespace {

#include "scenes/crowd/steering/heuristic-inl.h"

}  // namespace
}  // namespace THRONG_EIGHT_LANES

void decide_heuristic_wide(const SteeringView& people, std::span<const uint32_t> slots,
                           float* next_x_mps, float* next_y_mps) {
  THRONG_EIGHT_LANES::decide_each(people, slots, next_x_mps, next_y_mps);
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

SteeringFunction heuristic_on(SimdTarget target) {
  return THRONG_CHOOSE(resolved(target), decide_heuristic_wide, decide_heuristic_scalar);
}

}  // namespace throng
#endif
