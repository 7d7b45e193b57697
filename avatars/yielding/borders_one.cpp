#include <algorithm>
#include <array>
#include <cmath>

#include "avatars/gait/gait_curves.h"
#include "avatars/yielding/borders_kernel.h"
#include "base/elementary.h"
#include "base/simd/one_lane.h"

namespace throng {
namespace one_lane {
namespace {

#include "base/simd/angles-inl.h"
//
#include "avatars/yielding/borders-inl.h"
//
#include "avatars/yielding/wanted-inl.h"

}  // namespace
}  // namespace one_lane

float DrawnArm::share_of(float stilled) { return one_lane::share_of(stilled).v; }

YieldMotion wanted_one_by_one(const SeenBody& own, std::span<const SeenBody* const> near,
                              std::span<const NearWall> walls) {
  return one_lane::wanted_by(own, near, walls);
}

}  // namespace throng
