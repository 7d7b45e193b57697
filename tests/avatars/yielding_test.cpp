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
  return {x_m,      y_m, 0, 0, heading_rad, std::cos(heading_rad), std::sin(heading_rad),
          &yielder, 0,   {}};
}

/// Two who stay so far apart, and their arms where they are, give way until neither changes any
/// more.
void settle(Yielder& right, Yielder& left, float apart_m, float heading_rad = 0,
            const Rhythm& of_right = {}, const Rhythm& of_left = {}) {
  const float sin = std::sin(heading_rad), cos = std::cos(heading_rad);
  for (int i = 0; i < 600; ++i) {
    NearBody from_right = beside(0, apart_m, left, heading_rad);
    NearBody from_left = beside(-sin * apart_m, -cos * apart_m, right, -heading_rad);
    from_right.rhythm = of_left;
    from_left.rhythm = of_right;
    const YieldMotion a = wanted_yield(right, of_right, {&from_right, 1}, {});
    const YieldMotion b = wanted_yield(left, of_left, {&from_left, 1}, {});
    follow(a, 1.0f / 60, right.motion);
    follow(b, 1.0f / 60, left.motion);
  }
}

/// How far a body reaches in a direction with its arms where they are.
float reach_m(const Yielder& body, const Rhythm& rhythm, float angle_rad) {
  constexpr float kAround = Reaches::kDirections;
  const float angle = angle_rad - body.motion.turn_rad, direction = angle * Reaches::kPerRadian;
  float reach = body.outline->upper.at(direction - kAround * std::floor(direction / kAround));
  for (size_t side = 0; side < 2; ++side) {
    const DrawnArm drawn(body.motion.arms[side]);
    const Octagon &swung = body.swung->at(rhythm.phase).arms[side],
                  &hangs = body.outline->drawn[side];
    const float x = std::cos(angle), y = std::sin(angle);
    const float tucked_m =
        swung.reach_m(x, y) - std::abs(y) * drawn.tucked * (swung.across_m(y) - hangs.across_m(y));
    const float all_m = swung.reach_m(x, y) - std::abs(y) * (swung.across_m(y) - hangs.across_m(y));
    reach = std::max(reach, tucked_m + drawn.stilled * (hangs.reach_m(x, y) - all_m));
  }
  return body.scale * reach;
}

TEST(Yielding, TheAdultCan) { ASSERT_NE(adult().outline(), nullptr); }

TEST(Yielding, WhoIsAloneOrFarFromOthersDoesNothing) {
  const Yielder own = walker(), other = walker();
  EXPECT_FALSE(wanted_yield(own, {}, {}, {}).is_near);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> angle(-kHalfTurn, kHalfTurn), far(kYieldReach_m + 0.01f, 9);
  for (int i = 0; i < 1000; ++i) {
    const float a = angle(random), d = far(random);
    const NearBody near = beside(d * std::cos(a), d * std::sin(a), other, angle(random));
    const YieldMotion wanted = wanted_yield(own, {}, {&near, 1}, {});
    EXPECT_EQ(wanted.turn_rad, 0);
    EXPECT_EQ(wanted.arms[0] + wanted.arms[1], 0);
  }
}

TEST(Yielding, WhoGoesAwayIsNotGivenWayTo) {
  const Yielder own = walker(), other = walker();
  NearBody near = beside(0.96f, 0, other);
  near.vx_mps = 0.5f;
  EXPECT_FALSE(wanted_yield(own, {}, {&near, 1}, {}).is_near);
  near.vx_mps = -0.5f;
  EXPECT_TRUE(wanted_yield(own, {}, {&near, 1}, {}).is_near);
}

TEST(Yielding, TwoAbreastGiveWayUntilTheyFit) {
  for (int step = 0; step < 12; ++step)
    for (int i = 0; i < 16; ++i) {
      const float apart_m = 0.6f - 0.02f * static_cast<float>(step);
      const Rhythm of_right = {static_cast<float>(i) / 16, 0}, of_left = {0.3f, 0};
      Yielder right = walker(), left = walker();
      settle(right, left, apart_m, 0, of_right, of_left);
      EXPECT_LT(
          reach_m(right, of_right, 0.5f * kHalfTurn) + reach_m(left, of_left, -0.5f * kHalfTurn),
          apart_m + 0.01f)
          << apart_m << " " << i;
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
  const YieldMotion wanted = wanted_yield(own, {}, {}, {&wall, 1});
  EXPECT_GT(wanted.arms[1], 0.1f * DrawnArm::kTucked);
  EXPECT_EQ(wanted.arms[0], 0);
}

TEST(Yielding, AnArmThatSwingsToAndFroIsOnlyTuckedForWhatIsBeside) {
  const Yielder own = walker(), other = walker();
  for (int i = 0; i < 16; ++i) {
    const NearBody near = beside(0, 0.58f, other);
    const YieldMotion wanted = wanted_yield(own, {static_cast<float>(i) / 16, 0}, {&near, 1}, {});
    EXPECT_GT(wanted.arms[1], 0) << i;
    EXPECT_LE(wanted.arms[1], DrawnArm::kTucked + 1e-6f) << i;
    EXPECT_EQ(DrawnArm(wanted.arms[1]).stilled, 0) << i;
  }
}

TEST(Yielding, AnArmIsDrawnInForWhatItsSwingMeetsAndOnlyThen) {
  // Somebody stands ahead to the left: the left arm is ahead at the right foot's strike, phase 0,
  // and behind half a cycle later.
  const Yielder own = walker(1.5f), other = walker(0);
  NearBody near = beside(0.6f, 0.3f, other);
  EXPECT_GT(wanted_yield(own, {0, 0}, {&near, 1}, {}).arms[1], DrawnArm::kTucked);
  EXPECT_EQ(wanted_yield(own, {0.5f, 0}, {&near, 1}, {}).arms[1], 0);
  // What counts is where the arm will be when they are nearest, in 0.4 s.
  NearBody crossing = beside(0.6f, 0.7f, other);
  crossing.vy_mps = -1.75f;
  const float until = 0.4f * 0.9f;
  EXPECT_GT(wanted_yield(own, {1 - until, 0.9f}, {&crossing, 1}, {}).arms[1],
            wanted_yield(own, {0.5f - until, 0.9f}, {&crossing, 1}, {}).arms[1] + 0.2f);
}

TEST(Yielding, AnArmIsNotLetOutOnlyToBeDrawnInByTheSameSwing) {
  Yielder own = walker(1.5f);
  const Yielder other = walker(0);
  const NearBody near = beside(0.6f, 0.3f, other);
  own.motion.arms[1] = 0.9f;
  EXPECT_GT(wanted_yield(own, {0.5f, 0}, {&near, 1}, {}).arms[1], 0.3f);
}

TEST(Yielding, TuckingAndStillingGoFromNothingToAll) {
  EXPECT_EQ(DrawnArm(0).tucked, 0);
  EXPECT_EQ(DrawnArm(1).tucked, 1);
  EXPECT_EQ(DrawnArm(0).stilled, 0);
  EXPECT_FLOAT_EQ(DrawnArm(1).stilled, 1);
  for (int i = 0; i < 1000; ++i) {
    const float still = static_cast<float>(i) / 1000, more = still + 0.001f;
    EXPECT_LE(DrawnArm::share_of(still), DrawnArm::share_of(more));
    EXPECT_NEAR(DrawnArm(DrawnArm::share_of(still)).stilled, still, 0.005f);
    EXPECT_LE(DrawnArm(still).stilled, DrawnArm(more).stilled);
    EXPECT_LE(DrawnArm(still).tucked, DrawnArm(more).tucked);
  }
}

TEST(Yielding, WhatIsNotNeededAnyMoreIsGivenBack) {
  for (const float step_s : {1.0f / 100, 1.0f / 60, 1.0f / 25, 1.0f / 16}) {
    YieldMotion motion;
    motion.arms = {1, 0.7f};
    motion.turn_rad = 0.9f;
    float time_s = 0;
    while (motion.arms[0] > 0.02f && time_s < 5) {
      follow({}, step_s, motion);
      time_s += step_s;
    }
    EXPECT_LT(time_s, 0.9f) << step_s;
    while (motion.turn_rad > 0.02f && time_s < 5) {
      follow({}, step_s, motion);
      time_s += step_s;
    }
    EXPECT_LT(time_s, 1.6f) << step_s;
  }
}

TEST(Yielding, WhatIsWantedIsTheSameForTheMirroredScene) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> angle(-kHalfTurn, kHalfTurn), apart(0.45f, 0.9f);
  const Yielder own = walker(), other = walker();
  for (int i = 0; i < 300; ++i) {
    const float a = angle(random), d = apart(random), heading = angle(random);
    const NearBody near = beside(d * std::cos(a), d * std::sin(a), other, heading);
    NearBody mirrored = beside(d * std::cos(a), -d * std::sin(a), other, -heading);
    mirrored.rhythm.phase = 0.5f;  // the other foot's turn
    const YieldMotion one = wanted_yield(own, {}, {&near, 1}, {});
    const YieldMotion two = wanted_yield(own, {0.5f, 0}, {&mirrored, 1}, {});
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
          ASSERT_LE(std::abs(motion.arms_ps[side] - before.arms_ps[side]),
                    kYieldLimits.arm_ps2 * step_s * 1.0001f)
              << step_s << " " << change;
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

TEST(Yielding, TrunksComeToTheirLimitWithoutAJerk) {
  const YieldColumns& columns = adult().outline()->columns;
  std::vector<float> row(static_cast<size_t>(adult().column_count()));
  constexpr float kStep_s = 1.0f / 60, kDegree = kHalfTurn / 180;
  for (const float aside : {-1.0f, 1.0f}) {
    float last[2] = {};
    for (int i = 0; i < 600; ++i) {  // there and back, slower than any body turns
      const float t = static_cast<float>(i) / 600;
      Yield yield;
      yield.trunk_rad = aside * columns.most_trunk_rad * std::sin(kHalfTurn * t);
      const float phase = std::fmod(0.95f * kStep_s * static_cast<float>(i), 1.0f), speed = 1.4f;
      const float scale = 1;
      adult().postures({&phase, 1}, {&speed, 1}, {&scale, 1}, row);
      put_yield(columns, yield, row);
      const float now = row[static_cast<size_t>(columns.trunk)];
      if (i >= 2) {
        EXPECT_LT(std::abs(now - 2 * last[0] + last[1]) / (kStep_s * kStep_s), 1000 * kDegree) << i;
      }
      last[1] = last[0];
      last[0] = now;
    }
  }
}

}  // namespace
}  // namespace throng
