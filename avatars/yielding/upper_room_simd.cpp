// Eight parts at a time: upper_room-inl.h over vector registers.
#include <algorithm>
#include <cstddef>

#include "avatars/yielding/upper_room_kernel.h"
#include "base/simd/dispatch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "avatars/yielding/upper_room_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/eight_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace THRONG_EIGHT_LANES {
namespace {

#include "avatars/yielding/upper_room-inl.h"

static_assert(kAtOnce == kShapesAtOnce);

}  // namespace
}  // namespace THRONG_EIGHT_LANES

bool find_upper_box_wide(const UpperRoom::Shapes& shapes, std::span<const PartPose> poses,
                         const RoundRoom& all, RootBox& box) {
  return THRONG_EIGHT_LANES::upper_box(shapes, poses, all, box);
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

bool find_upper_box(const UpperRoom::Shapes& shapes, std::span<const PartPose> poses,
                    const RoundRoom& all, SimdTarget target, RootBox& box) {
  return THRONG_CHOOSE(target, find_upper_box_wide, find_upper_box_one_by_one)(shapes, poses, all,
                                                                               box);
}

}  // namespace throng
#endif
