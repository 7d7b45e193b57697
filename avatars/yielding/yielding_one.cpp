#include <algorithm>
#include <array>
#include <cmath>

#include "avatars/gait/gait_curves.h"
#include "avatars/yielding/yielding_kernels.h"
#include "base/elementary.h"
#include "base/simd/one_lane.h"

namespace throng {
namespace one_lane {
namespace {

#include "base/simd/angles-inl.h"
//
#include "avatars/yielding/borders-inl.h"

}  // namespace
}  // namespace one_lane

float DrawnArm::share_of(float stilled) { return one_lane::share_of(stilled).v; }

YieldMotion wanted_one_by_one(const SeenBody& own, std::span<const SeenBody* const> near,
                              std::span<const NearWall> walls) {
  return one_lane::wanted_by(own, near, walls);
}

namespace one_lane {
namespace {

#include "avatars/yielding/many_legs-inl.h"

}  // namespace
}  // namespace one_lane

void foresee_one_by_one(const LegNow& leg, const PlaceNumbers& ahead_s, size_t count,
                        ForeseenLeg& foreseen) {
  for (size_t i = 0; i < count; ++i) one_lane::foresee_at(i, leg, ahead_s, foreseen);
}

bool comes_near_one_by_one(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                           const LegOwner& whose, float clear_m, size_t count) {
  for (size_t i = 0; i < count; ++i)
    if (one_lane::comes_near_at(i, leg, own, other, whose, clear_m)) return true;
  return false;
}

bool foresee_near_one_by_one(const LegNow& leg, const PlaceNumbers& ahead_s, const LegPlaces& own,
                             const WhatIsNear& near, NearLeg& foreseen) {
  bool is_near = false;
  for (size_t i = 0; i < kEightTimes; ++i) {
    foreseen.is_near[i] = 0;
    is_near |= one_lane::foresee_near_at(i, leg, ahead_s, own, near, foreseen);
  }
  return is_near;
}

void add_nearness_one_by_one(const LegPlaces& places, const LegOwner& own,
                             std::span<const OtherLeg> others, float clear_m, PlaceNumbers& costs) {
  for (size_t i = 0; i < kPlaces; ++i)
    one_lane::add_nearness_at(i, places, own, others, clear_m, costs);
}

void add_nearness_in_one_by_one(const Rhythms& rhythms, const std::array<LegNow, 2>& own,
                                std::span<const LegsThen> others, float clear_m,
                                RhythmNumbers& costs) {
  for (size_t i = 0; i < kRhythms; ++i)
    one_lane::add_nearness_in_at(i, rhythms, own, others, clear_m, costs);
}

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
