// Legs of people near each other: what is foreseen of them is what walking does, and steps change
// only where legs would meet.
#include "avatars/yielding/footing.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/random.h"
#include "tests/avatars/gait_fixture.h"

namespace throng {
namespace {

using Eigen::Vector2f;
using test::Walking;

constexpr float kSpeed_mps = 1.3f;

/// An adult who walks as the gait has it.
Steps walks(const Vector2f& at_m, float phase, float speed_mps = kSpeed_mps) {
  const Gait& gait = Walking::adult().gait;
  Steps steps{};
  steps.root_m = at_m;
  steps.velocity_mps = {speed_mps, 0};
  steps.ahead = {1, 0};
  steps.scale = 1;
  steps.phase = phase;
  steps.track = gait.track_at(speed_mps, 1);
  steps.cycles_ps = steps.later_ps = speed_mps / steps.track.stride_m;
  steps.swing = &gait.swing();
  return steps;
}

Vector2f turned(const Vector2f& v, float cos, float sin) {
  return {cos * v.x() - sin * v.y(), sin * v.x() + cos * v.y()};
}

/// The same from somewhere else.
Steps moved(Steps steps, const Vector2f& by_m, float cos, float sin) {
  steps.root_m = by_m + turned(steps.root_m, cos, sin);
  steps.velocity_mps = turned(steps.velocity_mps, cos, sin);
  steps.ahead = turned(steps.ahead, cos, sin);
  return steps;
}

float drawn(uint64_t seed, uint32_t index, double low, double high) {
  return static_cast<float>(
      random_uniform({seed, 0, 0, Purpose::kSpawnPosition}, low, high, index));
}

TEST(Footing, WhoIsAloneWalksAsEver) {
  for (int step = 0; step < 20; ++step) {
    const float phase = 0.05f * static_cast<float>(step);
    const Steps own = walks({0, 0}, phase);
    EXPECT_EQ(stretch_for(own, {}, 1), 1);
    for (size_t side = 0; side < 2; ++side)
      EXPECT_EQ(landing_shift_m(own, side, {}), Vector2f(0, 0)) << "phase " << phase;
  }
}

TEST(Footing, SomebodyBesideOutOfReachChangesNothing) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Steps own = walks({0, 0}, drawn(seed, 0, 0, 1));
    const std::array<Steps, 1> near = {walks({0, 1.4f}, drawn(seed, 1, 0, 1))};
    EXPECT_EQ(stretch_for(own, near, 1), 1) << "seed " << seed;
    for (size_t side = 0; side < 2; ++side)
      EXPECT_EQ(landing_shift_m(own, side, near), Vector2f(0, 0)) << "seed " << seed;
  }
}

TEST(LegPath, ForeseesWhereTheGaitPutsTheFeet) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const float phase = drawn(seed, 0, 0, 1), speed_mps = drawn(seed, 1, 0.6, 1.8),
                ahead_s = drawn(seed, 2, 0, 2);
    const Steps now = walks({0, 0}, phase, speed_mps);
    const float later = phase + now.cycles_ps * ahead_s;
    const Steps then = walks({speed_mps * ahead_s, 0}, later - std::floor(later), speed_mps);
    for (size_t side = 0; side < 2; ++side) {
      const Vector2f foreseen = LegPath(now, side, 2).at(ahead_s).foot_m,
                     found = LegPath(then, side, 2).at(0).foot_m;
      EXPECT_LT((foreseen - found).norm(), 0.02f)
          << "seed " << seed << ", in " << ahead_s << " s: foreseen " << foreseen.transpose()
          << ", found " << found.transpose();
    }
  }
}

TEST(LegPath, AFootOnTheGroundStaysThereUntilItLifts) {
  const Steps now = walks({0, 0}, 0.05f);
  const LegPath path(now, 0, 2);
  const float lifts_s = (now.track.stance - 0.05f) / now.cycles_ps;
  for (int tenth = 0; tenth < 10; ++tenth)
    EXPECT_EQ(path.at(0.1f * static_cast<float>(tenth) * lifts_s).foot_m, path.at(0).foot_m);
  EXPECT_TRUE(path.at(lifts_s).stays);
}

TEST(Footing, AFootLandsWhereNoOtherIs) {
  int changed = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    Steps own = walks({0, 0}, 0.9f);
    // Somebody stands with a foot somewhere near where the right one would land.
    Steps other = walks({0, 0}, 0.2f, 0);
    other.cycles_ps = other.later_ps = 0;
    const float lands_s = LegPath(own, 0, 2).lands_s();
    const Vector2f lands = LegPath(own, 0, 2).at(lands_s).foot_m;
    other.root_m += lands - LegPath(other, 0, 2).at(0).foot_m +
                    Vector2f(drawn(seed, 0, -0.05, 0.15), drawn(seed, 1, -0.08, 0.08));
    const Vector2f there = LegPath(other, 0, 2).at(0).foot_m;
    const Vector2f shift = landing_shift_m(own, 0, {&other, 1});
    changed += shift != Vector2f(0, 0);
    EXPECT_GT((lands + shift - there).norm(), (lands - there).norm()) << "seed " << seed;
    EXPECT_LT(shift.norm(), 0.4f) << "seed " << seed;
  }
  EXPECT_EQ(changed, 200);
}

TEST(Footing, OutOfTimeBehindSomebodyCloseTheRhythmChanges) {
  const std::array<Steps, 1> out_of_step = {walks({0.5f, 0.1f}, 0.55f)};
  EXPECT_GT(std::abs(stretch_for(walks({0, 0}, 0.3f), out_of_step, 1) - 1), 0.05f);
}

TEST(Footing, IsTheSameSeenFromAnywhere) {
  for (uint64_t seed = 0; seed < 100; ++seed) {
    const Steps own = walks({0, 0}, drawn(seed, 0, 0, 1));
    const Steps other = walks({drawn(seed, 1, 0.3, 0.7), drawn(seed, 2, -0.4, 0.4)},
                              drawn(seed, 3, 0, 1), drawn(seed, 4, 1.1, 1.5));
    const Vector2f by_m(drawn(seed, 5, -5, 5), drawn(seed, 6, -5, 5));
    // A quarter turn is exact, so that no choice between equals can fall otherwise.
    const Steps own_there = moved(own, {0, 0}, 0, 1), other_there = moved(other, {0, 0}, 0, 1);
    EXPECT_EQ(stretch_for(own, {&other, 1}, 1), stretch_for(own_there, {&other_there, 1}, 1))
        << "seed " << seed;
    for (size_t side = 0; side < 2; ++side) {
      EXPECT_EQ(landing_shift_m(own, side, {&other, 1}),
                landing_shift_m(own_there, side, {&other_there, 1}))
          << "seed " << seed;
      const Vector2f here = LegPath(own, side, 2).at(0.7f).foot_m;
      const Vector2f there = LegPath(moved(own, by_m, 0.6f, 0.8f), side, 2).at(0.7f).foot_m;
      EXPECT_LT((by_m + turned(here, 0.6f, 0.8f) - there).norm(), 1e-5f) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace throng
