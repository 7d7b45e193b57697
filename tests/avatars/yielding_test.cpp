// Bodies that give way: nobody near, nothing; in a gap, both as much as it takes; never faster than
// joints move.
#include "avatars/yielding/yielding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "avatars/avatars.h"

namespace throng {
namespace {

constexpr float kHalfTurn = 3.14159265f;

const Gait& adult() {
  static const Gait gait(*load_model(adult_urdf()));
  return gait;
}

Yielder walker(float speed_mps = 1.3f, float scale = 1) {
  const Outline& outline = *adult().outline();
  return {&outline, &outline.swung_at(speed_mps, scale), scale, {}};
}

/// Somebody at a place, who goes as whoever looks does.
NearBody beside(float x_m, float y_m, const Yielder& yielder, float heading_rad = 0) {
  return {x_m, y_m, 0, 0, heading_rad, &yielder, 0};
}

/// Two who stay so far apart give way until neither changes any more.
void settle(Yielder& right, Yielder& left, float apart_m, float heading_rad = 0) {
  const float sin = std::sin(heading_rad), cos = std::cos(heading_rad);
  for (int i = 0; i < 600; ++i) {
    const NearBody from_right = beside(0, apart_m, left, heading_rad);
    const NearBody from_left = beside(-sin * apart_m, -cos * apart_m, right, -heading_rad);
    const YieldMotion a = wanted_yield(right, {&from_right, 1}, {});
    const YieldMotion b = wanted_yield(left, {&from_left, 1}, {});
    follow(a, 1.0f / 60, right.motion);
    follow(b, 1.0f / 60, left.motion);
  }
}

/// How far a body with its arms drawn in reaches in a direction.
float reach_m(const Yielder& body, float angle_rad) {
  constexpr float kAround = Reaches::kDirections;
  const float direction = (angle_rad - body.motion.turn_rad) * Reaches::kPerRadian;
  return body.scale * body.outline->upper.at(direction - kAround * std::floor(direction / kAround));
}

TEST(Yielding, TheAdultCan) { ASSERT_NE(adult().outline(), nullptr); }

TEST(Yielding, WhoIsAloneOrFarFromOthersDoesNothing) {
  const Yielder own = walker(), other = walker();
  EXPECT_FALSE(wanted_yield(own, {}, {}).is_near);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> angle(-kHalfTurn, kHalfTurn), far(kYieldReach_m + 0.01f, 9);
  for (int i = 0; i < 1000; ++i) {
    const float a = angle(random), d = far(random);
    const NearBody near = beside(d * std::cos(a), d * std::sin(a), other, angle(random));
    const YieldMotion wanted = wanted_yield(own, {&near, 1}, {});
    EXPECT_EQ(wanted.turn_rad, 0);
    EXPECT_EQ(wanted.arms[0] + wanted.arms[1], 0);
  }
}

TEST(Yielding, WhoGoesAwayIsNotGivenWayTo) {
  const Yielder own = walker(), other = walker();
  NearBody near = beside(0.96f, 0, other);
  near.vx_mps = 0.5f;
  EXPECT_FALSE(wanted_yield(own, {&near, 1}, {}).is_near);
  near.vx_mps = -0.5f;
  EXPECT_TRUE(wanted_yield(own, {&near, 1}, {}).is_near);
}

TEST(Yielding, TwoAbreastTurnUntilTheyFit) {
  for (int step = 0; step < 12; ++step) {
    const float apart_m = 0.6f - 0.02f * static_cast<float>(step);
    Yielder right = walker(), left = walker();
    settle(right, left, apart_m);
    EXPECT_LT(reach_m(right, 0.5f * kHalfTurn) + reach_m(left, -0.5f * kHalfTurn), apart_m);
    EXPECT_GT(right.motion.arms[1], 0.3f) << apart_m;
    EXPECT_GT(left.motion.arms[0], 0.3f) << apart_m;
  }
}

TEST(Yielding, WhoHasMoreRoomTurnsLess) {
  float before_rad = 2;
  for (const float apart_m : {0.38f, 0.42f, 0.46f, 0.5f, 0.54f, 0.62f}) {
    Yielder right = walker(), left = walker();
    settle(right, left, apart_m);
    const float most_rad =
        std::max(std::abs(right.motion.turn_rad), std::abs(left.motion.turn_rad));
    EXPECT_LE(most_rad, before_rad + 0.05f) << apart_m;
    before_rad = most_rad;
  }
  EXPECT_LT(before_rad, 0.05f);
}

TEST(Yielding, OfAWallTheArmBesideItIsDrawnIn) {
  const Yielder own = walker();
  const NearWall wall = {0, 1, 0.3f, 0};  // to the left
  const YieldMotion wanted = wanted_yield(own, {}, {&wall, 1});
  EXPECT_GT(wanted.arms[1], 0.3f);
  EXPECT_LT(wanted.arms[0], 0.2f);
}

TEST(Yielding, WhatIsWantedIsTheSameForTheMirroredScene) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> angle(-kHalfTurn, kHalfTurn), apart(0.45f, 0.9f);
  const Yielder own = walker(), other = walker();
  for (int i = 0; i < 300; ++i) {
    const float a = angle(random), d = apart(random), heading = angle(random);
    const NearBody near = beside(d * std::cos(a), d * std::sin(a), other, heading);
    const NearBody mirrored = beside(d * std::cos(a), -d * std::sin(a), other, -heading);
    const YieldMotion one = wanted_yield(own, {&near, 1}, {});
    const YieldMotion two = wanted_yield(own, {&mirrored, 1}, {});
    // The two arms of the adult are mirrored to a millimetre; which way to turn may be a draw.
    EXPECT_NEAR(std::abs(one.turn_rad), std::abs(two.turn_rad), 0.15f) << i;
    EXPECT_NEAR(one.arms[0] + one.arms[1], two.arms[0] + two.arms[1], 0.35f) << i;
  }
}

TEST(Yielding, FollowsWithinItsLimitsAndArrives) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> turn(-1.1f, 1.1f), share(0, 1);
  for (const float step_s : {1.0f / 100, 1.0f / 60, 1.0f / 25, 1.0f / 16}) {
    YieldMotion motion;
    for (int change = 0; change < 40; ++change) {
      YieldMotion wanted;
      wanted.turn_rad = turn(random);
      wanted.arms = {share(random), share(random)};
      for (int i = 0; i < static_cast<int>(0.4f / step_s); ++i) {
        const YieldMotion before = motion;
        follow(wanted, step_s, motion);
        ASSERT_LE(std::abs(motion.turn_rps), kYieldLimits.trunk_rps * 1.0001f);
        ASSERT_LE(std::abs(motion.turn_rps - before.turn_rps),
                  kYieldLimits.trunk_rps2 * step_s * 1.0001f);
        for (size_t side = 0; side < 2; ++side) {
          ASSERT_LE(std::abs(motion.arms_ps[side]), kYieldLimits.arm_ps * 1.0001f);
          ASSERT_GE(motion.arms[side], 0);
          ASSERT_LE(motion.arms[side], 1);
        }
      }
    }
    YieldMotion wanted;
    wanted.turn_rad = 0.8f;
    wanted.arms = {1, 0.5f};
    wanted.is_near = true;
    for (int i = 0; i < static_cast<int>(4 / step_s); ++i) follow(wanted, step_s, motion);
    EXPECT_NEAR(motion.turn_rad, 0.8f, 0.02f) << step_s;
    EXPECT_NEAR(motion.arms[0], 1, 0.02f) << step_s;
  }
}

TEST(Yielding, PostureRowsStayWithinTheJointsLimits) {
  const std::shared_ptr<const Model> model = load_model(adult_urdf());
  const Gait gait(*model);
  const YieldColumns& columns = gait.outline()->columns;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<float> row(static_cast<size_t>(gait.column_count()));
  for (int i = 0; i < 2000; ++i) {
    const float phase = 0.999f * unit(random), speed = 2 * unit(random), scale = 1;
    gait.postures({&phase, 1}, {&speed, 1}, {&scale, 1}, row);
    const float head_rad = row[static_cast<size_t>(columns.head)];
    gait.look(unit(random) - 0.5f, row);
    Yield yield;
    yield.trunk_rad = 2 * unit(random) - 1;
    yield.arms = {unit(random), unit(random)};
    const std::vector<float> before = row;
    put_yield(columns, yield, row);
    for (size_t c = 0; c < row.size(); ++c) {
      const JointColumn& limits = model->kinematics.columns()[c];
      ASSERT_GE(row[c], limits.lower) << c;
      ASSERT_LE(row[c], limits.upper) << c;
    }
    // The head looks where it looked, as far as what is bounded for looks lets it.
    const auto head = static_cast<size_t>(columns.head), trunk = static_cast<size_t>(columns.trunk);
    ASSERT_LE(std::abs(row[head] + row[trunk] - before[trunk] - head_rad), 0.5f + 1e-5f);
  }
}

}  // namespace
}  // namespace throng
