// Eight borders at a time: borders-inl.h over vector registers.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "avatars/gait/gait_curves.h"
#include "avatars/yielding/borders_kernel.h"
#include "base/elementary.h"
#include "base/simd/dispatch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "avatars/yielding/borders_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/eight_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace THRONG_EIGHT_LANES {
namespace {

#include "base/simd/angles-inl.h"
//
#include "avatars/yielding/borders-inl.h"
//
#include "avatars/yielding/wanted-inl.h"

}  // namespace
}  // namespace THRONG_EIGHT_LANES

YieldMotion wanted_wide(const SeenBody& own, std::span<const SeenBody* const> near,
                        std::span<const NearWall> walls) {
  return THRONG_EIGHT_LANES::wanted_by(own, near, walls);
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

YieldMotion wanted_yield(const SeenBody& own, std::span<const SeenBody* const> near,
                         std::span<const NearWall> walls, SimdTarget target) {
  assert(near.size() <= kMostNear && walls.size() <= kMostNearWalls);
  return THRONG_CHOOSE(target, wanted_wide, wanted_one_by_one)(own, near, walls);
}

}  // namespace throng
#endif
