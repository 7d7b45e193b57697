// Eight borders, times or shapes at a time, and two registers of places: the loops of yielding over
// vector registers.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "avatars/gait/gait_curves.h"
#include "avatars/yielding/yielding_kernels.h"
#include "base/elementary.h"
#include "base/simd/dispatch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "avatars/yielding/yielding_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace THRONG_EIGHT_LANES {
namespace {

#include "base/simd/angles-inl.h"
//
#include "avatars/yielding/borders-inl.h"

}  // namespace
}  // namespace THRONG_EIGHT_LANES

YieldMotion wanted_wide(const SeenBody& own, std::span<const SeenBody* const> near,
                        std::span<const NearWall> walls) {
  return THRONG_EIGHT_LANES::wanted_by(own, near, walls);
}

namespace register_pairs {
namespace {

#include "avatars/yielding/many_legs-inl.h"

static_assert(kPlaces % kAtOnce == 0);

}  // namespace
}  // namespace register_pairs
#if HWY_MAX_BYTES > 16
namespace eight_lanes {
namespace {

#include "avatars/yielding/many_legs-inl.h"

}  // namespace
}  // namespace eight_lanes
#endif

void foresee_wide(const LegNow& leg, const PlaceNumbers& ahead_s, size_t count,
                  ForeseenLeg& foreseen) {
  for (size_t i = 0; i < count; i += THRONG_EIGHT_LANES::kAtOnce)
    THRONG_EIGHT_LANES::foresee_at(i, leg, ahead_s, foreseen);
}

bool comes_near_wide(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                     const LegOwner& whose, float clear_m, size_t count) {
  for (size_t i = 0; i < count; i += THRONG_EIGHT_LANES::kAtOnce)
    if (THRONG_EIGHT_LANES::comes_near_at(i, leg, own, other, whose, clear_m)) return true;
  return false;
}

bool foresee_near_wide(const LegNow& leg, const PlaceNumbers& ahead_s, const LegPlaces& own,
                       const WhatIsNear& near, NearLeg& foreseen) {
  static_assert(THRONG_EIGHT_LANES::kAtOnce == kEightTimes);
  return THRONG_EIGHT_LANES::foresee_near_at(0, leg, ahead_s, own, near, foreseen);
}

void add_nearness_wide(const LegPlaces& places, const LegOwner& own,
                       std::span<const OtherLeg> others, float clear_m, PlaceNumbers& costs) {
  for (size_t i = 0; i < kPlaces; i += register_pairs::kAtOnce)
    register_pairs::add_nearness_at(i, places, own, others, clear_m, costs);
}

void add_nearness_in_wide(const Rhythms& rhythms, const std::array<LegNow, 2>& own,
                          std::span<const LegsThen> others, float clear_m, RhythmNumbers& costs) {
  static_assert(kRhythms % THRONG_EIGHT_LANES::kAtOnce == 0);
  for (size_t i = 0; i < kRhythms; i += THRONG_EIGHT_LANES::kAtOnce)
    THRONG_EIGHT_LANES::add_nearness_in_at(i, rhythms, own, others, clear_m, costs);
}

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

YieldMotion wanted_yield(const SeenBody& own, std::span<const SeenBody* const> near,
                         std::span<const NearWall> walls, SimdTarget target) {
  assert(near.size() <= kMostNear && walls.size() <= kMostNearWalls);
  return THRONG_CHOOSE(target, wanted_wide, wanted_one_by_one)(own, near, walls);
}

void foresee(const LegNow& leg, const PlaceNumbers& ahead_s, size_t count, SimdTarget target,
             ForeseenLeg& foreseen) {
  THRONG_CHOOSE(target, foresee_wide, foresee_one_by_one)(leg, ahead_s, count, foreseen);
}

bool comes_near(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                const LegOwner& whose, float clear_m, size_t count, SimdTarget target) {
  return THRONG_CHOOSE(target, comes_near_wide, comes_near_one_by_one)(leg, own, other, whose,
                                                                       clear_m, count);
}

bool foresee_near(const LegNow& leg, const PlaceNumbers& ahead_s, const LegPlaces& own,
                  const WhatIsNear& near, SimdTarget target, NearLeg& foreseen) {
  return THRONG_CHOOSE(target, foresee_near_wide, foresee_near_one_by_one)(leg, ahead_s, own, near,
                                                                           foreseen);
}

void add_nearness(const LegPlaces& places, const LegOwner& own, std::span<const OtherLeg> others,
                  float clear_m, SimdTarget target, PlaceNumbers& costs) {
  THRONG_CHOOSE(target, add_nearness_wide, add_nearness_one_by_one)
  (places, own, others, clear_m, costs);
}

void add_nearness_in(const Rhythms& rhythms, const std::array<LegNow, 2>& own,
                     std::span<const LegsThen> others, float clear_m, SimdTarget target,
                     RhythmNumbers& costs) {
  THRONG_CHOOSE(target, add_nearness_in_wide, add_nearness_in_one_by_one)
  (rhythms, own, others, clear_m, costs);
}

bool find_upper_box(const UpperRoom::Shapes& shapes, std::span<const PartPose> poses,
                    const RoundRoom& all, SimdTarget target, RootBox& box) {
  return THRONG_CHOOSE(target, find_upper_box_wide, find_upper_box_one_by_one)(shapes, poses, all,
                                                                               box);
}

}  // namespace throng
#endif
