// A place after the other: the reference for many_legs_simd.cpp. Internal to the folder.
#pragma once

#include "avatars/yielding/many_legs.h"

namespace throng {

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

}  // namespace throng
