// The loops that decide the speed of yielding, one lane at a time: the reference for
// yielding_simd.cpp. Internal to the folder. One rule: every SIMD target gives the same bits.
#pragma once

#include <cstddef>
#include <span>

#include "avatars/yielding/many_legs.h"
#include "avatars/yielding/upper_room.h"
#include "avatars/yielding/yielding.h"

namespace throng {

YieldMotion wanted_one_by_one(const SeenBody& own, std::span<const SeenBody* const> near,
                              std::span<const NearWall> walls);

void foresee_one_by_one(const LegNow& leg, const PlaceNumbers& ahead_s, size_t count,
                        ForeseenLeg& foreseen);
bool comes_near_one_by_one(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                           const LegOwner& whose, float clear_m, size_t count);
bool foresee_near_one_by_one(const LegNow& leg, const PlaceNumbers& ahead_s, const LegPlaces& own,
                             const WhatIsNear& near, NearLeg& foreseen);
void add_nearness_one_by_one(const LegPlaces& places, const LegOwner& own,
                             std::span<const OtherLeg> others, float clear_m, PlaceNumbers& costs);
void add_nearness_in_one_by_one(const Rhythms& rhythms, const std::array<LegNow, 2>& own,
                                std::span<const LegsThen> others, float clear_m,
                                RhythmNumbers& costs);

inline constexpr size_t kShapesAtOnce = 8;

/// The box around all; false: `all` does not hold it.
bool find_upper_box(const UpperRoom::Shapes& shapes, std::span<const PartPose> poses,
                    const RoundRoom& all, SimdTarget target, RootBox& box);

bool find_upper_box_one_by_one(const UpperRoom::Shapes& shapes, std::span<const PartPose> poses,
                               const RoundRoom& all, RootBox& box);

}  // namespace throng
