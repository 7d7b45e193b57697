// Body avoidance: no change without neighbours, room made in a gap by both, rates within limits.
#include "avatars/body_avoidance/body_avoidance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "avatars/avatars.h"
#include "avatars/gait/gait_curves.h"
#include "base/portable_math.h"
#include "tests/avatars/gait_fixture.h"

namespace throng::body_avoidance_test {
namespace {

constexpr float kHalfTurn = 3.14159265f;

const Gait& adult() {
  static const Gait gait(*load_model(adult_urdf()));
  return gait;
}

/// Returns a walker at the origin.
BodyState2d walker(float speed_mps = 1.3f, float phase = 0) {
  BodyState2d body;
  body.sweep = &adult().outline()->sweep_at(speed_mps, body.scale);
  body.sway_m = body.sweep->sway_m();
  body.phase = phase;
  return body;
}

/// Returns a walker at a place with its own speed and heading.
BodyState2d neighbour_at(float x_m, float y_m, float speed_mps = 1.3f, float heading_rad = 0) {
  BodyState2d body = walker(speed_mps);
  body.x_m = x_m;
  body.y_m = y_m;
  body.cos = std::cos(heading_rad);
  body.sin = std::sin(heading_rad);
  return body;
}

AvoidanceMotion target_motion(const BodyState2d& own, const std::vector<BodyState2d>& neighbours,
                              const std::vector<WallState2d>& walls = {},
                              SimdTarget target = SimdTarget::kScalar) {
  std::vector<const BodyState2d*> seen;
  for (const BodyState2d& body : neighbours) seen.push_back(&body);
  return target_avoidance(own, seen, walls, target);
}

void take(const AvoidanceMotion& motion, BodyState2d& body) {
  body.turn_rad = motion.turn_rad;
  body.arms = motion.arms;
}

/// Lets two standing bodies, arms included, adapt until neither changes.
void settle(BodyState2d& right, BodyState2d& left) {
  AvoidanceMotion of_right, of_left;
  for (int i = 0; i < 600; ++i) {
    const AvoidanceMotion a = target_motion(right, {left}), b = target_motion(left, {right});
    follow(a, 1.0f / 60, of_right);
    follow(b, 1.0f / 60, of_left);
    take(of_right, right);
    take(of_left, left);
  }
}

/// Returns the reach in the direction of a unit vector: by the nearest corners of the octagon.
float reach_m(const Octagon& octagon, float x, float y) {
  float max_m = -1e9f;
  constexpr float kDiagonal = 0.70710678f;
  const float directions[8][2] = {
      {1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
      {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};
  for (size_t i = 0; i < 8; ++i) {  // the corner of two neighbouring sides
    const size_t j = (i + 1) % 8;
    const float det = directions[i][0] * directions[j][1] - directions[i][1] * directions[j][0];
    const float a = octagon.reaches_m[i], b = octagon.reaches_m[j];
    const float corner_x = (a * directions[j][1] - b * directions[i][1]) / det,
                corner_y = (b * directions[i][0] - a * directions[j][0]) / det;
    // The direction lies between these two sides.
    const float from = directions[i][0] * y - directions[i][1] * x,
                to = x * directions[j][1] - y * directions[j][0];
    if (from >= -1e-6f && to >= -1e-6f) max_m = std::max(max_m, corner_x * x + corner_y * y);
  }
  return max_m;
}

/// Returns the reach of a body in a direction with its current arms.
float reach_m(const BodyState2d& body, float angle_rad) {
  constexpr float kFullCircle = RadialProfile::kDirections;
  const Outline& outline = body.sweep->outline();
  const float angle = angle_rad - body.turn_rad, direction = angle * RadialProfile::kPerRadian;
  float reach = outline.upper.at(direction - kFullCircle * std::floor(direction / kFullCircle));
  for (size_t side = 0; side < 2; ++side) {
    const ArmTuck arm_tuck(body.arms[side]);
    const Octagon &sweep = body.sweep->at(LimbSweep::phase_index(body.phase)).arms[side],
                  &hangs = outline.tucked[side];
    const float x = std::cos(angle), y = std::sin(angle);
    const size_t across = y > 0 ? 2 : 6;
    const float tuck_gain_m = std::abs(y) * (sweep.reaches_m[across] - hangs.reaches_m[across]);
    const float all_m = reach_m(sweep, x, y) - tuck_gain_m;
    const float tucked_m = reach_m(sweep, x, y) - arm_tuck.tuck * tuck_gain_m;
    reach = std::max(reach, tucked_m + arm_tuck.swing_damping * (reach_m(hangs, x, y) - all_m));
  }
  return body.scale * reach;
}

TEST(BodyAvoidance, SupportsTheAdult) { ASSERT_NE(adult().outline(), nullptr); }

TEST(BodyAvoidance, DoesNothingAloneOrFarFromOthers) {
  const BodyState2d own = walker();
  EXPECT_FALSE(target_motion(own, {}).has_constraints);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> angle(-kHalfTurn, kHalfTurn),
      far(kAvoidanceReach_m + 0.01f, 9);
  for (int i = 0; i < 1000; ++i) {
    const float a = angle(random), d = far(random);
    const AvoidanceMotion motion =
        target_motion(own, {neighbour_at(d * std::cos(a), d * std::sin(a), 1.3f, angle(random))});
    EXPECT_EQ(motion.turn_rad, 0);
    EXPECT_EQ(motion.arms[0] + motion.arms[1], 0);
  }
}

TEST(BodyAvoidance, IgnoresDepartingNeighbours) {
  BodyState2d neighbour = neighbour_at(0.96f, 0);
  neighbour.vx_mps = 0.5f;
  EXPECT_FALSE(target_motion(walker(), {neighbour}).has_constraints);
  neighbour.vx_mps = -0.5f;
  EXPECT_TRUE(target_motion(walker(), {neighbour}).has_constraints);
}

// Closer than 0.4 m, two facing each other do not fit.
TEST(BodyAvoidance, SeparatesTwoAbreast) {
  for (int step = 0; step < 11; ++step)
    for (int i = 0; i < 16; ++i) {
      const float apart_m = 0.6f - 0.02f * static_cast<float>(step);
      BodyState2d right = walker(1.3f, static_cast<float>(i) / 16), left = neighbour_at(0, apart_m);
      left.phase = 0.3f;
      settle(right, left);
      const float both_m = reach_m(right, 0.5f * kHalfTurn) + reach_m(left, -0.5f * kHalfTurn);
      EXPECT_LT(both_m, apart_m + 0.01f) << apart_m << " " << i;
    }
}

TEST(BodyAvoidance, TurnsLessWithMoreClearance) {
  float before_rad = 2;
  for (const float apart_m : {0.38f, 0.42f, 0.46f, 0.5f, 0.54f, 0.62f}) {
    BodyState2d right = walker(), left = neighbour_at(0, apart_m);
    settle(right, left);
    const float max_rad = std::max(std::abs(right.turn_rad), std::abs(left.turn_rad));
    EXPECT_LE(max_rad, before_rad + 0.05f) << apart_m;
    before_rad = max_rad;
  }
  EXPECT_LT(before_rad, 0.05f);
}

TEST(BodyAvoidance, ReleasesObstructingTurnsFastAndOthersSlowly) {
  const auto half_a_second_after = [&](float x_m, float y_m) {
    BodyState2d own = walker();
    AvoidanceMotion motion;
    motion.turn_rad = own.turn_rad = -0.6f;
    for (int step = 0; step < 30; ++step) {
      follow(target_motion(own, {neighbour_at(x_m, y_m)}), 1.0f / 60, motion);
      take(motion, own);
    }
    return motion.turn_rad;
  };
  // Turned to the right, the left shoulder meets a person ahead on the left.
  EXPECT_GT(half_a_second_after(0.22f, 0.34f), -0.1f);
  EXPECT_LT(half_a_second_after(0, 0.6f), -0.4f);
}

TEST(BodyAvoidance, DoesNotTurnThroughLargerDeficits) {
  const std::vector<BodyState2d> neighbours = {neighbour_at(0, 0.44f), neighbour_at(0, -0.44f)};
  BodyState2d own = walker();  // has a deficit to both sides unless turned
  for (const float turn_rad : {0.7f, -0.7f}) {
    own.turn_rad = turn_rad;
    EXPECT_GT(target_motion(own, neighbours).turn_rad * turn_rad, 0.25f) << turn_rad;
  }
}

TEST(BodyAvoidance, TucksTheArmNextToAWall) {
  const AvoidanceMotion motion = target_motion(walker(), {}, {{0, 1, 0.3f, 0}});  // to the left
  EXPECT_GT(motion.arms[1], 0.1f * ArmTuck::kTuckShare);
  EXPECT_EQ(motion.arms[0], 0);
}

TEST(BodyAvoidance, DoesNotDampTheSwingForLateralNeighbours) {
  for (int i = 0; i < 16; ++i) {
    const AvoidanceMotion motion =
        target_motion(walker(1.3f, static_cast<float>(i) / 16), {neighbour_at(0, 0.58f)});
    EXPECT_GT(motion.arms[1], 0) << i;
    EXPECT_LE(motion.arms[1], ArmTuck::kTuckShare + 1e-6f) << i;
    EXPECT_EQ(ArmTuck(motion.arms[1]).swing_damping, 0) << i;
  }
}

TEST(BodyAvoidance, TucksTheArmOnlyWhenItsSwingMeetsANeighbour) {
  // The left arm is in front at phase 0, and behind half a cycle later.
  const BodyState2d neighbour = neighbour_at(0.6f, 0.3f, 0);
  EXPECT_GT(target_motion(walker(1.5f, 0), {neighbour}).arms[1], ArmTuck::kTuckShare);
  EXPECT_EQ(target_motion(walker(1.5f, 0.5f), {neighbour}).arms[1], 0);
  // The arm's place at the closest approach, in 0.4 s, counts.
  BodyState2d crossing = neighbour_at(0.6f, 0.7f, 0);
  crossing.vy_mps = -1.75f;
  const float until = 0.4f * 0.9f;
  BodyState2d early = walker(1.5f, 1 - until), late = walker(1.5f, 0.5f - until);
  early.cadence_hz = late.cadence_hz = 0.9f;
  EXPECT_GT(target_motion(early, {crossing}).arms[1],
            target_motion(late, {crossing}).arms[1] + 0.2f);
}

TEST(BodyAvoidance, KeepsTheArmTuckedWithinASwing) {
  BodyState2d own = walker(1.5f, 0.5f);
  own.arms[1] = 0.9f;
  EXPECT_GT(target_motion(own, {neighbour_at(0.58f, 0.3f, 0)}).arms[1], 0.3f);
}

TEST(BodyAvoidance, MapsSharesToTuckAndDamping) {
  EXPECT_EQ(ArmTuck(0).tuck, 0);
  EXPECT_EQ(ArmTuck(1).tuck, 1);
  EXPECT_EQ(ArmTuck(0).swing_damping, 0);
  EXPECT_FLOAT_EQ(ArmTuck(1).swing_damping, 1);
  for (int i = 0; i < 1000; ++i) {
    const float still = static_cast<float>(i) / 1000, more = still + 0.001f;
    EXPECT_LE(ArmTuck::share_of(still), ArmTuck::share_of(more));
    EXPECT_NEAR(ArmTuck(ArmTuck::share_of(still)).swing_damping, still, 0.005f);
    EXPECT_LE(ArmTuck(still).swing_damping, ArmTuck(more).swing_damping);
    EXPECT_LE(ArmTuck(still).tuck, ArmTuck(more).tuck);
  }
}

TEST(BodyAvoidance, ReturnsToRestWithoutConstraints) {
  for (const float step_s : {1.0f / 100, 1.0f / 60, 1.0f / 25, 1.0f / 16}) {
    AvoidanceMotion motion;
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
    while (!motion.is_at_rest() && time_s < 5) {
      follow({}, step_s, motion);
      time_s += step_s;
    }
    EXPECT_LT(time_s, 2.5f) << step_s << ": negligible values end";
  }
}

TEST(BodyAvoidance, StaysWithinMaxExtentAtAnyTuck) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> share(0, 1), angle(-kHalfTurn, kHalfTurn), speed(0, 2.2f);
  float nearest_m = 1;
  for (int i = 0; i < 20000; ++i) {
    BodyState2d body = walker(speed(random), share(random));
    body.arms = {share(random), share(random)};
    const MaxExtent& max_extent = body.sweep->max_extent();
    Octagon octagon;
    octagon.reaches_m = {max_extent.ahead_m,   max_extent.oblique_m, max_extent.aside_m,
                         max_extent.oblique_m, max_extent.ahead_m,   max_extent.oblique_m,
                         max_extent.aside_m,   max_extent.oblique_m};
    const float direction = angle(random), x = std::cos(direction), y = std::sin(direction);
    const float left_m = reach_m(octagon, x, y) - reach_m(body, direction);
    nearest_m = std::min(nearest_m, left_m);
    ASSERT_GT(left_m, -1e-5f) << "draw " << i << ", " << direction << " rad";
    body.turn_rad = angle(random) / 2;
    ASSERT_GT(max_extent.max_m - reach_m(body, direction), -1e-5f) << "draw " << i << ", turned";
  }
  EXPECT_LT(nearest_m, 0.02f) << "bound is too wide";
}

TEST(BodyAvoidance, ComputesTheSameTargetWithAndWithoutTheShortcut) {
  int at_rest_count = 0, moving_count = 0;
  for (uint32_t seed = 1; seed <= 3000; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-1, 1), share(0, 1), direction(-1, 1);
    std::vector<BodyState2d> neighbours;
    for (int i = 0; i < 3; ++i) {
      neighbours.push_back(neighbour_at(place(random), place(random), 1 + direction(random),
                                        kHalfTurn * direction(random)));
      BodyState2d& body = neighbours.back();
      body.vx_mps = direction(random), body.vy_mps = direction(random);
      body.phase = share(random), body.cadence_hz = share(random);
      if (i == 1) body.turn_rad = direction(random);
      if (i == 2) body.arms = {share(random), share(random)};
    }
    std::erase_if(neighbours,
                  [](const BodyState2d& body) { return std::hypot(body.x_m, body.y_m) < 0.4f; });
    BodyState2d own = walker(1.3f, share(random));
    const AvoidanceMotion at_rest = target_motion(own, neighbours);
    own.turn_rad = 1e-6f;  // no longer at rest
    const AvoidanceMotion closer = target_motion(own, neighbours);
    EXPECT_EQ(at_rest.has_constraints, closer.has_constraints) << "seed " << seed;
    EXPECT_NEAR(at_rest.turn_rad, closer.turn_rad, 1e-3f) << "seed " << seed;
    for (size_t side = 0; side < 2; ++side)
      EXPECT_NEAR(at_rest.arms[side], closer.arms[side], 1e-3f) << "seed " << seed;
    const bool stays_at_rest =
        at_rest.turn_rad == 0 && at_rest.arms[0] == 0 && at_rest.arms[1] == 0;
    ++(stays_at_rest ? at_rest_count : moving_count);
  }
  EXPECT_GT(at_rest_count, 100);
  EXPECT_GT(moving_count, 1000);
}

TEST(BodyAvoidance, PredictsTheSwayOfTheGait) {
  for (const test::Walking& walking : test::Walking::styles()) {
    const PosableModel posable(*walking.model);
    const auto column =
        static_cast<size_t>(posable.column_of_joint(posable.joint_of("pelvis_lateral")));
    const Outline& outline = *walking.gait.outline();
    for (size_t speed = 0; speed < outline.sweeps.size(); ++speed) {
      const float root = static_cast<float>(speed) / outline.per_sqrt_speed;
      const float speed_mps = root * root * outline.leg_length_m;
      const LimbSweep& sweep = outline.sweeps[speed];
      for (int i = 0; i < 64; ++i) {
        const double phase = i / 64.0;
        const double sway_m = -static_cast<double>(sweep.sway_m()) *
                              sin_cos(kTurn * (phase - GaitCurves::kSwayPhase)).sin;
        EXPECT_NEAR(walking.posture(static_cast<float>(phase), speed_mps)[column], sway_m, 1e-3)
            << walking.name() << ", " << speed_mps << " m/s, phase " << phase;
      }
    }
  }
}

TEST(BodyAvoidance, IsMirrorSymmetric) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> angle(-kHalfTurn, kHalfTurn), apart(0.45f, 0.9f);
  for (int i = 0; i < 300; ++i) {
    const float a = angle(random), d = apart(random), heading = angle(random);
    const BodyState2d neighbour = neighbour_at(d * std::cos(a), d * std::sin(a), 1.3f, heading);
    BodyState2d mirrored = neighbour_at(d * std::cos(a), -d * std::sin(a), 1.3f, -heading);
    mirrored.phase = 0.5f;  // the other foot's turn
    const AvoidanceMotion one = target_motion(walker(), {neighbour});
    const AvoidanceMotion two = target_motion(walker(1.3f, 0.5f), {mirrored});
    // The adult's arms mirror each other to a millimetre; a tie decides which way to turn.
    EXPECT_NEAR(std::abs(one.turn_rad), std::abs(two.turn_rad), 0.15f) << i;
    EXPECT_NEAR(one.arms[0] + one.arms[1], two.arms[0] + two.arms[1], 0.35f) << i;
  }
}

TEST(BodyAvoidance, IsEqualOnAllTargetsAndUnderRotation) {
  std::mt19937 random(11);
  const auto in = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  int constrained_count = 0, turned = 0, tucked_count = 0;
  for (int seed = 0; seed < 2000; ++seed) {
    const auto random_body = [&](float x_m, float y_m) {
      BodyState2d body = neighbour_at(x_m, y_m, in(0, 1.8f), in(-kHalfTurn, kHalfTurn));
      body.vx_mps = in(-1.5f, 1.5f);
      body.vy_mps = in(-1.5f, 1.5f);
      body.phase = in(0, 1);
      body.cadence_hz = in(0, 1.1f);
      body.turn_rad = in(-1, 1);
      body.arms = {in(-1, 1), in(0, 1)};
      body.arms[0] = std::max(body.arms[0], 0.0f);
      if (in(0, 1) < 0.2f) body.turn_rad = 0, body.arms = {};
      body.scale = in(0.8f, 1.1f);
      if (in(0, 1) < 0.1f) {
        body.disc_m = 0.2f;
        body.sweep = nullptr;
      }
      return body;
    };
    BodyState2d own = random_body(in(-50, 50), in(-50, 50));
    own.sweep = walker(in(0, 1.8f)).sweep;
    own.disc_m = 0;
    std::vector<BodyState2d> neighbours;
    for (int i = static_cast<int>(in(0, kMaxAvoidedBodies + 0.99f)); i > 0; --i)
      neighbours.push_back(random_body(own.x_m + in(-1.2f, 1.2f), own.y_m + in(-1.2f, 1.2f)));
    std::vector<WallState2d> walls;
    for (int i = static_cast<int>(in(-3, kMaxAvoidedWalls + 0.99f)); i > 0; --i) {
      const float direction = in(-kHalfTurn, kHalfTurn);
      walls.push_back({std::cos(direction), std::sin(direction), in(0.1f, 0.9f), in(-1, 1)});
    }
    const AvoidanceMotion first = target_motion(own, neighbours, walls);
    constrained_count += first.has_constraints;
    turned += std::abs(first.turn_rad) > 0.1f;
    tucked_count += first.arms[0] > 0.1f;
    for (const SimdTarget target : simd_targets_of_this_machine()) {
      const AvoidanceMotion found = target_motion(own, neighbours, walls, target);
      ASSERT_EQ(found.turn_rad, first.turn_rad) << seed;
      ASSERT_EQ(found.arms, first.arms) << seed;
      ASSERT_EQ(found.has_constraints, first.has_constraints) << seed;
    }
    if (!walls.empty()) continue;  // walls are relative to the body
    const float turn = in(-kHalfTurn, kHalfTurn), cos = std::cos(turn), sin = std::sin(turn);
    const auto turn_all = [&](BodyState2d& body) {
      const BodyState2d b = body;
      body.x_m = cos * b.x_m - sin * b.y_m, body.y_m = cos * b.y_m + sin * b.x_m;
      body.vx_mps = cos * b.vx_mps - sin * b.vy_mps, body.vy_mps = cos * b.vy_mps + sin * b.vx_mps;
      body.cos = cos * b.cos - sin * b.sin, body.sin = cos * b.sin + sin * b.cos;
    };
    turn_all(own);
    for (BodyState2d& body : neighbours) turn_all(body);
    const AvoidanceMotion again = target_motion(own, neighbours, walls);
    // A tie decides which way to turn.
    if (std::abs(again.turn_rad - first.turn_rad) > 0.05f) continue;
    for (size_t side = 0; side < 2; ++side)
      ASSERT_NEAR(again.arms[side], first.arms[side], 0.2f) << seed;
  }
  EXPECT_GT(constrained_count, 1500);
  EXPECT_GT(turned, 500);
  EXPECT_GT(tucked_count, 500);
}

TEST(BodyAvoidance, ReachesTheTargetWithinItsLimits) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> turn(-1.1f, 1.1f), share(0, 1);
  for (const float step_s : {1.0f / 100, 1.0f / 60, 1.0f / 25, 1.0f / 16}) {
    AvoidanceMotion motion;
    for (int change = 0; change < 40; ++change) {
      AvoidanceMotion to;
      to.turn_rad = turn(random);
      to.arms = {share(random), share(random)};
      to.is_urgent = change % 2 == 1;
      for (int i = 0; i < static_cast<int>(0.4f / step_s); ++i) {
        const AvoidanceMotion before = motion;
        follow(to, step_s, motion);
        ASSERT_LE(std::abs(motion.turn_rps), kAvoidanceLimits.trunk_rps * 1.0001f);
        ASSERT_LE(std::abs(motion.turn_rps - before.turn_rps),
                  kAvoidanceLimits.trunk_rps2 * step_s * 1.0001f);
        for (size_t side = 0; side < 2; ++side) {
          ASSERT_LE(std::abs(motion.arms_ps[side]), kAvoidanceLimits.arm_ps * 1.0001f);
          ASSERT_LE(std::abs(motion.arms_ps[side] - before.arms_ps[side]),
                    kAvoidanceLimits.arm_ps2 * step_s * 1.0001f);
          ASSERT_EQ(motion.arms[side], std::clamp(motion.arms[side], 0.0f, 1.0f));
        }
      }
    }
    AvoidanceMotion to;
    to.turn_rad = 0.8f;
    to.arms = {1, 0.5f};
    to.has_constraints = true;
    for (int i = 0; i < static_cast<int>(4 / step_s); ++i) follow(to, step_s, motion);
    EXPECT_NEAR(motion.turn_rad, 0.8f, 0.02f) << step_s;
    EXPECT_NEAR(motion.arms[0], 1, 0.02f) << step_s;
  }
}

TEST(BodyAvoidance, KeepsPostureRowsWithinJointLimits) {
  const std::shared_ptr<const Model> model = load_model(adult_urdf());
  const Gait gait(*model);
  const AvoidanceColumns& columns = gait.outline()->columns;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<float> row(static_cast<size_t>(gait.column_count()));
  for (int i = 0; i < 2000; ++i) {
    const float phase = 0.999f * unit(random), speed = 2 * unit(random), scale = 1;
    gait.postures({&phase, 1}, {&speed, 1}, {&scale, 1}, row);
    const float head_rad = row[static_cast<size_t>(columns.head)];
    gait.apply_head_yaw(unit(random) - 0.5f, row);
    AvoidancePosture avoidance;
    avoidance.trunk_rad = 2 * unit(random) - 1;
    avoidance.arms = {unit(random), unit(random)};
    const std::vector<float> before = row;
    apply_avoidance(columns, avoidance, {}, row);
    for (size_t c = 0; c < row.size(); ++c) {
      const JointColumn& limits = model->kinematics.columns()[c];
      ASSERT_GE(row[c], limits.lower) << c;
      ASSERT_LE(row[c], limits.upper) << c;
    }
    // The head keeps its direction within the bound on head yaw.
    const auto head = static_cast<size_t>(columns.head), trunk = static_cast<size_t>(columns.trunk);
    ASSERT_LE(std::abs(row[head] + row[trunk] - before[trunk] - head_rad), 0.5f + 1e-5f);
  }
}

TEST(BodyAvoidance, ApproachesTheTrunkLimitSmoothly) {
  const AvoidanceColumns& columns = adult().outline()->columns;
  std::vector<float> row(static_cast<size_t>(adult().column_count()));
  constexpr float kStep_s = 1.0f / 60, kDegree = kHalfTurn / 180;
  for (const float aside : {-1.0f, 1.0f}) {
    float last[2] = {};
    for (int i = 0; i < 600; ++i) {  // to and fro, slower than any body turns
      const float t = static_cast<float>(i) / 600;
      AvoidancePosture avoidance;
      avoidance.trunk_rad = aside * columns.max_trunk_rad * std::sin(kHalfTurn * t);
      const float phase = std::fmod(0.95f * kStep_s * static_cast<float>(i), 1.0f), speed = 1.4f;
      const float scale = 1;
      adult().postures({&phase, 1}, {&speed, 1}, {&scale, 1}, row);
      apply_avoidance(columns, avoidance, {}, row);
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
}  // namespace throng::body_avoidance_test
