// Legs, many at once: the same as one after the other, for every way of computing them.
#include "avatars/yielding/many_legs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/avatars/footing_fixture.h"
#include "tests/avatars/leg_path.h"
#include "tests/same_bits.h"

namespace throng::many_legs_test {
namespace {

using Eigen::Vector2f;
using test::drawn;
using test::LegPath;
using test::walks;

/// Somebody anywhere, any way, with feet somewhat off.
Steps anybody(uint64_t seed, uint32_t index) {
  const auto in = [&](uint32_t i, double low, double high) {
    return drawn(seed, 20 * index + i, low, high);
  };
  Steps steps = walks({in(0, -1, 1), in(1, -1, 1)}, in(2, 0, 1), in(3, 0.5, 1.8));
  const float way = in(4, -3, 3), heading = in(5, -0.3, 0.3);
  steps.velocity_mps = steps.velocity_mps.norm() * Vector2f(std::cos(way), std::sin(way));
  steps.ahead = {std::cos(way + heading), std::sin(way + heading)};
  steps.scale = in(6, 0.8, 1.2);
  for (uint32_t i = 0; i < 4; ++i) {
    steps.shift_m[i] = in(7 + i, -0.1, 0.1);
    steps.landing_m[i] = in(11 + i, -0.1, 0.1);
  }
  if (seed % 10 == 0) steps.cycles_ps = 0;
  return steps;
}

float distance_m(const LegPlace& a, const LegPlace& b) {
  return std::max(
      {(a.foot_m - b.foot_m).norm(), (a.shin_m - b.shin_m).norm(), (a.knee_m - b.knee_m).norm()});
}

/// Squares of what points of two legs lack, from points along the other foot half a
/// millimetre apart.
double slow_nearness(const LegPlace& a, const LegOwner& a_owner, const OtherLeg& b, float clear_m) {
  const auto lack2 = [](double distance, double reach) {
    const double lack = std::max(reach - distance, 0.0);
    return lack * lack;
  };
  double feet = 1e9;
  for (const float along : {-0.01f, 0.0775f, 0.165f})
    for (int i = 0; i <= 350; ++i) {
      const float there = -0.01f + 0.0005f * static_cast<float>(i);
      const Vector2f from = a.foot_m + a_owner.scale * along * a_owner.ahead;
      const Vector2f to = b.place.foot_m + b.owner.scale * there * b.owner.ahead;
      feet = std::min(feet, static_cast<double>((from - to).norm()));
    }
  const double scales = a_owner.scale + b.owner.scale, clear = clear_m;
  return lack2(feet, 0.05 * scales + clear) +
         lack2((a.shin_m - b.place.shin_m).norm(), 0.055 * scales + clear) +
         lack2((a.knee_m - b.place.knee_m).norm(), 0.055 * scales + clear);
}

TEST(ManyLegs, AreForeseenAsOneStepAfterTheOther) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const Steps steps = anybody(seed, 0);
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 2.4);
    for (size_t side = 0; side < 2; ++side) {
      ForeseenLeg foreseen;
      foresee(LegNow(steps, side), ahead_s, kPlaces, SimdTarget::kScalar, foreseen);
      LegPath path(steps, side, steps.cycles_ps, 0);
      for (size_t i = 0; i < kPlaces; ++i)
        EXPECT_LT(distance_m(foreseen.places.at(i), path.at(ahead_s[i])), 1e-3f)
            << "seed " << seed << ", side " << side << ", in " << ahead_s[i] << " s";
    }
  }
}

TEST(ManyLegs, AreForeseenAlikeByEveryTarget) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const LegNow leg(anybody(seed, 0), seed % 2);
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 2.4);
    ForeseenLeg first;
    foresee(leg, ahead_s, kPlaces, SimdTarget::kScalar, first);
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      ForeseenLeg found;
      foresee(leg, ahead_s, kPlaces, target, found);
      EXPECT_TRUE(same_bits(found, first)) << "seed " << seed;
    }
  }
}

TEST(ManyLegs, AreAsNearAsPointsOfThemAre) {
  int near = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const Steps own = anybody(seed, 0), other = anybody(seed, 1);
    const LegOwner owner = {own.ahead, own.scale};
    std::array<OtherLeg, 2> others;
    for (size_t side = 0; side < 2; ++side)
      others[side] = {LegPath(other, side, other.cycles_ps, 0).at(0), {other.ahead, other.scale}};
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 1);
    ForeseenLeg foreseen;
    foresee(LegNow(own, 0), ahead_s, kPlaces, SimdTarget::kScalar, foreseen);
    alignas(64) PlaceNumbers first = {};
    add_nearness(foreseen.places, owner, others, 0.2f, SimdTarget::kScalar, first);
    for (size_t i = 0; i < kPlaces; ++i) {
      double expected = 0;
      for (const OtherLeg& leg : others)
        expected += slow_nearness(foreseen.places.at(i), owner, leg, 0.2f);
      near += expected > 0;
      EXPECT_NEAR(first[i], expected, 1e-3 * std::sqrt(expected) + 1e-5) << "seed " << seed;
    }
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      alignas(64) PlaceNumbers found = {};
      add_nearness(foreseen.places, owner, others, 0.2f, target, found);
      EXPECT_TRUE(same_bits(found, first)) << "seed " << seed;
    }
  }
  EXPECT_GT(near, 300);
}

TEST(ManyLegs, ComeNearIfTheyDoAtAnyTime) {
  constexpr float kClear_m = 0.2f;
  constexpr size_t kCount = 16;  // whole registers
  int near_count = 0;
  for (uint64_t seed = 0; seed < 400; ++seed) {
    const Steps own = anybody(seed, 0), other = anybody(seed, 1);
    const LegOwner owner = {own.ahead, own.scale}, whose = {other.ahead, other.scale};
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 0.3);
    ForeseenLeg mine, theirs;
    foresee(LegNow(own, 0), ahead_s, kPlaces, SimdTarget::kScalar, mine);
    foresee(LegNow(other, 1), ahead_s, kPlaces, SimdTarget::kScalar, theirs);
    double nearness = 0;
    for (size_t i = 0; i < kCount; ++i)
      nearness += slow_nearness(mine.places.at(i), owner, {theirs.places.at(i), whose}, kClear_m);
    near_count += nearness > 0;
    if (nearness > 0 && nearness < 1e-6) continue;  // either will do
    for (const SimdTarget target : simd_targets_of_this_machine())
      EXPECT_EQ(comes_near(mine.places, owner, theirs.places, whose, kClear_m, kCount, target),
                nearness > 0)
          << "seed " << seed;
  }
  EXPECT_GT(near_count, 50);
  EXPECT_LT(near_count, 350);
}

TEST(ManyLegs, NearOnesAreThoseThatAreForeseenNearAndStay) {
  constexpr float kFar_m = 0.6f, kClear_m = 0.07f;
  int near_count = 0, touching = 0;
  for (uint64_t seed = 0; seed < 400; ++seed) {
    const Steps own = anybody(seed, 0), other = anybody(seed, 1);
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 1);
    ForeseenLeg mine, theirs;
    foresee(LegNow(own, 0), ahead_s, kPlaces, SimdTarget::kScalar, mine);
    foresee(LegNow(other, 1), ahead_s, kPlaces, SimdTarget::kScalar, theirs);
    const WhatIsNear near = {{own.ahead, own.scale}, {other.ahead, other.scale}, kFar_m, kClear_m};
    bool is_near = false;
    for (size_t i = 0; i < kEightTimes; ++i)
      is_near =
          is_near || ((mine.places.at(i).foot_m - theirs.places.at(i).foot_m).norm() <= kFar_m &&
                      theirs.stays[i] > 0);
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      NearLeg found;
      ASSERT_EQ(foresee_near(LegNow(other, 1), ahead_s, mine.places, near, target, found), is_near)
          << "seed " << seed;
      for (size_t i = 0; is_near && i < kEightTimes; ++i) {
        const float apart_m = (mine.places.at(i).foot_m - theirs.places.at(i).foot_m).norm();
        ASSERT_EQ(found.is_near[i], apart_m <= kFar_m && theirs.stays[i] > 0 ? 1.0f : 0.0f);
        if (found.is_near[i] == 0) continue;
        ++near_count;
        ASSERT_EQ(distance_m(found.places.at(i), theirs.places.at(i)), 0) << "seed " << seed;
        const double expected =
            slow_nearness(mine.places.at(i), near.own, {theirs.places.at(i), near.other}, kClear_m);
        touching += expected > 0;
        ASSERT_NEAR(found.nearness[i], expected, 1e-3 * std::sqrt(expected) + 1e-5) << seed;
      }
    }
  }
  EXPECT_GT(near_count, 500);
  EXPECT_GT(touching, 100);
}

TEST(ManyLegs, InARhythmAreAsNearAsOneStepAfterTheOtherBringsThem) {
  int near = 0;
  for (uint64_t seed = 1; seed < 30; ++seed) {
    Steps own = anybody(seed, 0);
    if (seed % 10 == 0) continue;
    own.root_m = {0, 0};
    own.ahead = {1, 0};
    own.scale = 1;
    const Steps other = anybody(seed, 1);
    std::array<LegsThen, 8> thens;
    for (uint32_t k = 0; k < thens.size(); ++k) {
      LegsThen& then = thens[k];
      then.ahead_s = drawn(seed, 100 + k, 0, 2.4);
      then.weight = drawn(seed, 110 + k, 0.1, 10);
      then.count = 1 + k % 2;
      for (size_t side = 0; side < then.count; ++side)
        then.legs[side] = {LegPath(other, side, other.cycles_ps, 0).at(then.ahead_s),
                           {other.ahead, other.scale}};
    }
    Rhythms rhythms;
    rhythms.lead_s = drawn(seed, 120, 0.5, 1.5);
    for (uint32_t i = 0; i < kRhythms; ++i) {
      rhythms.soon_ps[i] = drawn(seed, 200 + i, 0.6, 1.2);
      rhythms.later_ps[i] = drawn(seed, 300 + i, 0.6, 1.2);
    }
    const std::array<LegNow, 2> legs = {LegNow(own, 0), LegNow(own, 1)};
    alignas(64) RhythmNumbers first = {};
    add_nearness_in(rhythms, legs, thens, 0.2f, SimdTarget::kScalar, first);
    for (size_t i = 0; i < kRhythms; ++i) {
      double expected = 0;
      for (size_t side = 0; side < 2; ++side) {
        Steps in_rhythm = own;
        in_rhythm.cycles_ps = rhythms.soon_ps[i];
        LegPath path(in_rhythm, side, rhythms.later_ps[i], rhythms.lead_s);
        for (const LegsThen& then : thens)
          for (size_t k = 0; k < then.count; ++k)
            expected +=
                static_cast<double>(then.weight) *
                slow_nearness(path.at(then.ahead_s), {own.ahead, own.scale}, then.legs[k], 0.2f);
      }
      near += expected > 0;
      EXPECT_NEAR(first[i], expected, 0.01 * std::sqrt(expected) + 1e-3)
          << "seed " << seed << ", " << rhythms.soon_ps[i] << " and " << rhythms.later_ps[i]
          << " cycles a second";
    }
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      alignas(64) RhythmNumbers found = {};
      add_nearness_in(rhythms, legs, thens, 0.2f, target, found);
      EXPECT_TRUE(same_bits(found, first)) << "seed " << seed;
    }
  }
  EXPECT_GT(near, 200);
}

}  // namespace
}  // namespace throng::many_legs_test
