// Leg prediction: batches on every SIMD target equal single legs, step by step.
#include "avatars/body_avoidance/leg_prediction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/avatars/foot_placement_fixture.h"
#include "tests/avatars/leg_path.h"
#include "tests/same_bits.h"

namespace throng::leg_prediction_test {
namespace {

using Eigen::Vector2f;
using test::drawn;
using test::LegPath;
using test::walks;

/// Returns a random walker with displaced feet.
WalkState random_walker(uint64_t seed, uint32_t index) {
  const auto in = [&](uint32_t i, double low, double high) {
    return drawn(seed, 20 * index + i, low, high);
  };
  WalkState steps = walks({in(0, -1, 1), in(1, -1, 1)}, in(2, 0, 1), in(3, 0.5, 1.8));
  const float way = in(4, -3, 3), heading = in(5, -0.3, 0.3);
  steps.velocity_mps = steps.velocity_mps.norm() * Vector2f(std::cos(way), std::sin(way));
  steps.ahead = {std::cos(way + heading), std::sin(way + heading)};
  steps.scale = in(6, 0.8, 1.2);
  for (uint32_t i = 0; i < 4; ++i) {
    steps.shift_m[i] = in(7 + i, -0.1, 0.1);
    steps.landing_m[i] = in(11 + i, -0.1, 0.1);
  }
  if (seed % 10 == 0) steps.cadence_hz = 0;
  return steps;
}

float distance_m(const LegPlace& a, const LegPlace& b) {
  return std::max(
      {(a.foot_m - b.foot_m).norm(), (a.shin_m - b.shin_m).norm(), (a.knee_m - b.knee_m).norm()});
}

/// Squared deficits of two legs, from points of the other foot half a millimetre apart.
double slow_clearance_cost(const LegPlace& a, const LegOwner& a_owner, const OtherLeg& b,
                           float clearance_m) {
  const auto deficit_squared = [](double distance, double reach) {
    const double deficit = std::max(reach - distance, 0.0);
    return deficit * deficit;
  };
  double feet = 1e9;
  for (const float along : {-0.01f, 0.0775f, 0.165f})
    for (int i = 0; i <= 350; ++i) {
      const float there = -0.01f + 0.0005f * static_cast<float>(i);
      const Vector2f from = a.foot_m + a_owner.scale * along * a_owner.ahead;
      const Vector2f to = b.place.foot_m + b.owner.scale * there * b.owner.ahead;
      feet = std::min(feet, static_cast<double>((from - to).norm()));
    }
  const double scales = a_owner.scale + b.owner.scale, clear = clearance_m;
  return deficit_squared(feet, 0.05 * scales + clear) +
         deficit_squared((a.shin_m - b.place.shin_m).norm(), 0.055 * scales + clear) +
         deficit_squared((a.knee_m - b.place.knee_m).norm(), 0.055 * scales + clear);
}

TEST(LegPrediction, MatchesPathsStepByStep) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const WalkState steps = random_walker(seed, 0);
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 2.4);
    for (size_t side = 0; side < 2; ++side) {
      PredictedLeg predicted;
      predict(LegState(steps, side), ahead_s, kPlaces, SimdTarget::kScalar, predicted);
      LegPath path(steps, side, steps.cadence_hz, 0);
      for (size_t i = 0; i < kPlaces; ++i)
        EXPECT_LT(distance_m(predicted.places.at(i), path.at(ahead_s[i])), 1e-3f)
            << "seed " << seed << ", side " << side << ", in " << ahead_s[i] << " s";
    }
  }
}

TEST(LegPrediction, IsEqualOnAllTargets) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const LegState leg(random_walker(seed, 0), seed % 2);
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 2.4);
    PredictedLeg first;
    predict(leg, ahead_s, kPlaces, SimdTarget::kScalar, first);
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      PredictedLeg found;
      predict(leg, ahead_s, kPlaces, target, found);
      EXPECT_TRUE(same_bits(found, first)) << "seed " << seed;
    }
  }
}

TEST(LegPrediction, MatchesDistancesOfSampledPoints) {
  int near = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const WalkState own = random_walker(seed, 0), other = random_walker(seed, 1);
    const LegOwner owner = {own.ahead, own.scale};
    std::array<OtherLeg, 2> others;
    for (size_t side = 0; side < 2; ++side)
      others[side] = {LegPath(other, side, other.cadence_hz, 0).at(0), {other.ahead, other.scale}};
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 1);
    PredictedLeg predicted;
    predict(LegState(own, 0), ahead_s, kPlaces, SimdTarget::kScalar, predicted);
    alignas(64) PlaceNumbers first = {};
    add_clearance_cost(predicted.places, owner, others, 0.2f, SimdTarget::kScalar, first);
    for (size_t i = 0; i < kPlaces; ++i) {
      double expected = 0;
      for (const OtherLeg& leg : others)
        expected += slow_clearance_cost(predicted.places.at(i), owner, leg, 0.2f);
      near += expected > 0;
      EXPECT_NEAR(first[i], expected, 1e-3 * std::sqrt(expected) + 1e-5) << "seed " << seed;
    }
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      alignas(64) PlaceNumbers found = {};
      add_clearance_cost(predicted.places, owner, others, 0.2f, target, found);
      EXPECT_TRUE(same_bits(found, first)) << "seed " << seed;
    }
  }
  EXPECT_GT(near, 300);
}

TEST(LegPrediction, DetectsConflictsAtAnyTime) {
  constexpr float kClear_m = 0.2f;
  constexpr size_t kCount = 16;  // whole registers
  int conflict_count = 0;
  for (uint64_t seed = 0; seed < 400; ++seed) {
    const WalkState own = random_walker(seed, 0), other = random_walker(seed, 1);
    const LegOwner owner = {own.ahead, own.scale}, other_owner = {other.ahead, other.scale};
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 0.3);
    PredictedLeg own_leg, other_leg;
    predict(LegState(own, 0), ahead_s, kPlaces, SimdTarget::kScalar, own_leg);
    predict(LegState(other, 1), ahead_s, kPlaces, SimdTarget::kScalar, other_leg);
    double cost = 0;
    for (size_t i = 0; i < kCount; ++i)
      cost += slow_clearance_cost(own_leg.places.at(i), owner,
                                  {other_leg.places.at(i), other_owner}, kClear_m);
    conflict_count += cost > 0;
    if (cost > 0 && cost < 1e-6) continue;  // either result is valid
    for (const SimdTarget target : simd_targets_of_this_machine())
      EXPECT_EQ(violates_clearance(own_leg.places, owner, other_leg.places, other_owner, kClear_m,
                                   kCount, target),
                cost > 0)
          << "seed " << seed;
  }
  EXPECT_GT(conflict_count, 50);
  EXPECT_LT(conflict_count, 350);
}

TEST(LegPrediction, FindsRelevantLegsLikeSinglePredictions) {
  constexpr float kFar_m = 0.6f, kClear_m = 0.07f;
  int conflict_count = 0, touching = 0;
  for (uint64_t seed = 0; seed < 400; ++seed) {
    const WalkState own = random_walker(seed, 0), other = random_walker(seed, 1);
    alignas(64) PlaceNumbers ahead_s;
    for (uint32_t i = 0; i < kPlaces; ++i) ahead_s[i] = drawn(seed, 100 + i, 0, 1);
    PredictedLeg own_leg, other_leg;
    predict(LegState(own, 0), ahead_s, kPlaces, SimdTarget::kScalar, own_leg);
    predict(LegState(other, 1), ahead_s, kPlaces, SimdTarget::kScalar, other_leg);
    const LegQuery query = {{own.ahead, own.scale}, {other.ahead, other.scale}, kFar_m, kClear_m};
    bool is_relevant = false;
    for (size_t i = 0; i < kPredictionTimes; ++i)
      is_relevant =
          is_relevant ||
          ((own_leg.places.at(i).foot_m - other_leg.places.at(i).foot_m).norm() <= kFar_m &&
           other_leg.is_grounded[i] > 0);
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      LegClearance found;
      ASSERT_EQ(
          predict_clearance(LegState(other, 1), ahead_s, own_leg.places, query, target, found),
          is_relevant)
          << "seed " << seed;
      for (size_t i = 0; is_relevant && i < kPredictionTimes; ++i) {
        const float apart_m = (own_leg.places.at(i).foot_m - other_leg.places.at(i).foot_m).norm();
        ASSERT_EQ(found.is_relevant[i],
                  apart_m <= kFar_m && other_leg.is_grounded[i] > 0 ? 1.0f : 0.0f);
        if (found.is_relevant[i] == 0) continue;
        ++conflict_count;
        ASSERT_EQ(distance_m(found.places.at(i), other_leg.places.at(i)), 0) << "seed " << seed;
        const double expected = slow_clearance_cost(
            own_leg.places.at(i), query.own, {other_leg.places.at(i), query.other}, kClear_m);
        touching += expected > 0;
        ASSERT_NEAR(found.cost[i], expected, 1e-3 * std::sqrt(expected) + 1e-5) << seed;
      }
    }
  }
  EXPECT_GT(conflict_count, 500);
  EXPECT_GT(touching, 100);
}

TEST(LegPrediction, ScoresCadencesLikePathsStepByStep) {
  int near = 0;
  for (uint64_t seed = 1; seed < 30; ++seed) {
    WalkState own = random_walker(seed, 0);
    if (seed % 10 == 0) continue;
    own.root_m = {0, 0};
    own.ahead = {1, 0};
    own.scale = 1;
    const WalkState other = random_walker(seed, 1);
    std::array<PredictedLegs, 8> thens;
    for (uint32_t k = 0; k < thens.size(); ++k) {
      PredictedLegs& then = thens[k];
      then.ahead_s = drawn(seed, 100 + k, 0, 2.4);
      then.weight = drawn(seed, 110 + k, 0.1, 10);
      then.count = 1 + k % 2;
      for (size_t side = 0; side < then.count; ++side)
        then.legs[side] = {LegPath(other, side, other.cadence_hz, 0).at(then.ahead_s),
                           {other.ahead, other.scale}};
    }
    CadenceCandidates cadences;
    cadences.lead_s = drawn(seed, 120, 0.5, 1.5);
    for (uint32_t i = 0; i < kCadences; ++i) {
      cadences.soon_ps[i] = drawn(seed, 200 + i, 0.6, 1.2);
      cadences.later_ps[i] = drawn(seed, 300 + i, 0.6, 1.2);
    }
    const std::array<LegState, 2> legs = {LegState(own, 0), LegState(own, 1)};
    alignas(64) CadenceNumbers first = {};
    add_cadence_cost(cadences, legs, thens, 0.2f, SimdTarget::kScalar, first);
    for (size_t i = 0; i < kCadences; ++i) {
      double expected = 0;
      for (size_t side = 0; side < 2; ++side) {
        WalkState in_rhythm = own;
        in_rhythm.cadence_hz = cadences.soon_ps[i];
        LegPath path(in_rhythm, side, cadences.later_ps[i], cadences.lead_s);
        for (const PredictedLegs& then : thens)
          for (size_t k = 0; k < then.count; ++k)
            expected += static_cast<double>(then.weight) *
                        slow_clearance_cost(path.at(then.ahead_s), {own.ahead, own.scale},
                                            then.legs[k], 0.2f);
      }
      near += expected > 0;
      EXPECT_NEAR(first[i], expected, 0.01 * std::sqrt(expected) + 1e-3)
          << "seed " << seed << ", " << cadences.soon_ps[i] << " and " << cadences.later_ps[i]
          << " cycles per second";
    }
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      alignas(64) CadenceNumbers found = {};
      add_cadence_cost(cadences, legs, thens, 0.2f, target, found);
      EXPECT_TRUE(same_bits(found, first)) << "seed " << seed;
    }
  }
  EXPECT_GT(near, 200);
}

}  // namespace
}  // namespace throng::leg_prediction_test
