#include <algorithm>

#include "avatars/yielding/upper_room_kernel.h"
#include "base/simd/one_lane.h"

namespace throng {
namespace one_lane {
namespace {

#include "avatars/yielding/upper_room-inl.h"

}  // namespace
}  // namespace one_lane

bool find_upper_box_one_by_one(const UpperRoom::Shapes& shapes, std::span<const PartPose> poses,
                               const RoundRoom& all, RootBox& box) {
  return one_lane::upper_box(shapes, poses, all, box);
}

}  // namespace throng
