// Foot placement: predicted legs match the gait, and steps change only where legs would meet.
#include "avatars/body_avoidance/foot_placement.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "avatars/body_avoidance/leg_prediction.h"
#include "tests/avatars/foot_placement_fixture.h"
#include "tests/avatars/leg_path.h"

namespace throng::foot_placement_test {
namespace {

using Eigen::Vector2f;
using test::drawn;
using test::LegPath;
using test::walks;

Vector2f turned(const Vector2f& v, float cos, float sin) {
  return {cos * v.x() - sin * v.y(), sin * v.x() + cos * v.y()};
}

/// Returns the same steps, moved and rotated.
WalkState moved(WalkState steps, const Vector2f& by_m, float cos, float sin) {
  steps.root_m = by_m + turned(steps.root_m, cos, sin);
  steps.velocity_mps = turned(steps.velocity_mps, cos, sin);
  steps.ahead = turned(steps.ahead, cos, sin);
  return steps;
}

LegPath path_of(const WalkState& steps, size_t side) { return {steps, side, steps.cadence_hz, 0}; }

float stride_scale(const WalkState& own, std::span<const WalkState> neighbours) {
  std::vector<RootMotion> courses;
  for (const WalkState& other : neighbours) courses.push_back({other.root_m, other.velocity_mps});
  const LegEncounters encounters = find_encounters(courses, {own.root_m, own.velocity_mps});
  std::vector<WalkState> steps;
  for (size_t i = 0; i < encounters.count; ++i)
    steps.push_back(neighbours[encounters.all[i].neighbour]);
  return stride_scale_for(own, steps, encounters, 1, resolved(SimdTarget::kBest));
}

Vector2f landing(const WalkState& own, size_t side, std::span<const WalkState> neighbours) {
  FootPlacement landing(own, side, resolved(SimdTarget::kBest));
  if (!landing.is_due()) return {0, 0};
  for (const WalkState& other : neighbours)
    if (landing.may_conflict(other.root_m, other.velocity_mps)) landing.add(other);
  return landing.shift_m();
}

TEST(FootPlacement, ChangesNothingAlone) {
  for (int step = 0; step < 20; ++step) {
    const float phase = 0.05f * static_cast<float>(step);
    const WalkState own = walks({0, 0}, phase);
    EXPECT_EQ(stride_scale(own, {}), 1);
    for (size_t side = 0; side < 2; ++side)
      EXPECT_EQ(landing(own, side, {}), Vector2f(0, 0)) << "phase " << phase;
  }
}

TEST(FootPlacement, ChangesNothingForNeighboursOutOfReach) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const WalkState own = walks({0, 0}, drawn(seed, 0, 0, 1));
    const std::array<WalkState, 1> neighbours = {walks({0, 1.4f}, drawn(seed, 1, 0, 1))};
    EXPECT_EQ(stride_scale(own, neighbours), 1) << "seed " << seed;
    for (size_t side = 0; side < 2; ++side)
      EXPECT_EQ(landing(own, side, neighbours), Vector2f(0, 0)) << "seed " << seed;
  }
}

TEST(FootPlacement, PredictsTheFeetOfTheGait) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const float phase = drawn(seed, 0, 0, 1), speed_mps = drawn(seed, 1, 0.6, 1.8),
                ahead_s = drawn(seed, 2, 0, 2);
    const WalkState now = walks({0, 0}, phase, speed_mps);
    const float later = phase + now.cadence_hz * ahead_s;
    const WalkState then = walks({speed_mps * ahead_s, 0}, later - std::floor(later), speed_mps);
    for (size_t side = 0; side < 2; ++side) {
      const Vector2f predicted = path_of(now, side).at(ahead_s).foot_m,
                     found = path_of(then, side).at(0).foot_m;
      EXPECT_LT((predicted - found).norm(), 0.02f)
          << "seed " << seed << ", in " << ahead_s << " s: predicted " << predicted.transpose()
          << ", found " << found.transpose();
    }
  }
}

/// Squared deficits of two legs to a clearance of 7 cm when one lands `shift` from its place.
float clearance_cost(const WalkState& own, const LegPlace& lands, const Vector2f& shift,
                     const WalkState& other) {
  LegPlaces places{};
  const auto put = [&places](const LegPlace& at) {
    places.foot_x[0] = at.foot_m.x(), places.foot_y[0] = at.foot_m.y();
    places.shin_x[0] = at.shin_m.x(), places.shin_y[0] = at.shin_m.y();
    places.knee_x[0] = at.knee_m.x(), places.knee_y[0] = at.knee_m.y();
  };
  put({lands.foot_m + shift, lands.shin_m + 0.75f * shift, lands.knee_m + 0.5f * shift});
  std::array<OtherLeg, 2> legs;
  for (size_t side = 0; side < 2; ++side)
    legs[side] = {path_of(other, side).at(0), {other.ahead, other.scale}};
  alignas(64) PlaceNumbers costs = {};
  add_clearance_cost(places, {own.ahead, own.scale}, legs, 0.07f, SimdTarget::kScalar, costs);
  return costs[0];
}

TEST(FootPlacement, LandsClearOfOtherFeet) {
  int changed = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    WalkState own = walks({0, 0}, 0.9f);
    // A person stands with a foot near the landing point of the right one.
    WalkState other = walks({0, 0}, 0.2f, 0);
    other.cadence_hz = 0;
    const LegPlace lands = path_of(own, 0).at(LegState(own, 0).lands_s());
    other.root_m += lands.foot_m - path_of(other, 0).at(0).foot_m +
                    Vector2f(drawn(seed, 0, -0.05, 0.1), drawn(seed, 1, -0.04, 0.04));
    const Vector2f shift = landing(own, 0, {&other, 1});
    changed += shift != Vector2f(0, 0);
    EXPECT_LT(clearance_cost(own, lands, shift, other), clearance_cost(own, lands, {0, 0}, other))
        << "seed " << seed;
    EXPECT_LT(shift.norm(), 0.4f) << "seed " << seed;
  }
  EXPECT_EQ(changed, 200);
}

TEST(FootPlacement, AdaptsCadenceCloseBehindAWalkerOutOfStep) {
  const std::array<WalkState, 1> out_of_step = {walks({0.5f, 0.1f}, 0.55f)};
  EXPECT_GT(std::abs(stride_scale(walks({0, 0}, 0.3f), out_of_step) - 1), 0.05f);
}

TEST(FootPlacement, IsInvariantUnderRotationAndTranslation) {
  for (uint64_t seed = 0; seed < 100; ++seed) {
    const WalkState own = walks({0, 0}, drawn(seed, 0, 0, 1));
    const WalkState other = walks({drawn(seed, 1, 0.3, 0.7), drawn(seed, 2, -0.4, 0.4)},
                                  drawn(seed, 3, 0, 1), drawn(seed, 4, 1.1, 1.5));
    const Vector2f by_m(drawn(seed, 5, -5, 5), drawn(seed, 6, -5, 5));
    // A quarter turn is exact, and cannot change a choice between equal costs.
    const WalkState own_there = moved(own, {0, 0}, 0, 1), other_there = moved(other, {0, 0}, 0, 1);
    EXPECT_EQ(stride_scale(own, {&other, 1}), stride_scale(own_there, {&other_there, 1}))
        << "seed " << seed;
    for (size_t side = 0; side < 2; ++side) {
      EXPECT_EQ(landing(own, side, {&other, 1}), landing(own_there, side, {&other_there, 1}))
          << "seed " << seed;
      const Vector2f here = path_of(own, side).at(0.7f).foot_m;
      const Vector2f there = path_of(moved(own, by_m, 0.6f, 0.8f), side).at(0.7f).foot_m;
      EXPECT_LT((by_m + turned(here, 0.6f, 0.8f) - there).norm(), 1e-5f) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace throng::foot_placement_test
