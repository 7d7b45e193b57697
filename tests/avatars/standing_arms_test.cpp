// Standing postures: chosen by id, within joints and bounds, changed at limited rates.
#include "avatars/body_avoidance/standing_arms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "avatars/body_avoidance/body_avoidance.h"
#include "avatars/body_avoidance/upper_body_bounds.h"
#include "avatars/stepping/standing.h"
#include "base/portable_math.h"
#include "tests/avatars/gait_fixture.h"

namespace throng::standing_arms_test {
namespace {

using test::Walking;

std::vector<StandingPosture> all_means() {
  std::vector<StandingPosture> all;
  for (size_t hold = 0; hold < kArmHoldCount; ++hold)
    for (const bool is_mirrored : {false, true})
      all.push_back(mean_standing_posture(static_cast<ArmHold>(hold), is_mirrored));
  return all;
}

TEST(StandingPosture, VariesByIdReproducibly) {
  constexpr uint64_t kPeople = 20000;
  for (const uint64_t seed : {uint64_t{1}, uint64_t{2}}) {
    std::array<double, kArmHoldCount> counts{};
    double mirrored = 0;
    std::set<std::array<float, 4>> different;
    for (uint64_t id = 0; id < kPeople; ++id) {
      const StandingPosture posture = standing_posture(seed, id);
      counts[static_cast<size_t>(posture.hold)] += 1;
      mirrored += posture.is_mirrored ? 1 : 0;
      different.insert(posture.arms_rad[1]);
      EXPECT_LE(std::abs(posture.trunk_rad), kMaxStandingTrunk_rad);
      EXPECT_LE(std::abs(posture.head_rad), kMaxStandingHead_rad);
      EXPECT_EQ(standing_posture(seed, id).arms_rad, posture.arms_rad);
    }
    double shares = 0;
    for (size_t hold = 0; hold < kArmHoldCount; ++hold) {
      const double share = share_of(static_cast<ArmHold>(hold));
      EXPECT_NEAR(counts[hold] / kPeople, share, 0.015) << "hold " << hold << ", seed " << seed;
      EXPECT_GT(share, 0.05);
      shares += share;
    }
    EXPECT_NEAR(shares, 1, 1e-6);
    EXPECT_NEAR(mirrored / kPeople, 0.5, 0.02) << "seed " << seed;
    EXPECT_GT(different.size(), kPeople - 10) << "people look alike, seed " << seed;
  }
  EXPECT_NE(standing_posture(1, 7).arms_rad, standing_posture(2, 7).arms_rad);
}

/// A standing body in transition to a posture, maybe with turned trunk and tucked arms.
struct Stander {
  std::vector<float> row;

  Stander(const Walking& walking, const StandingPosture& posture, const AvoidancePosture& avoidance,
          float shift_m, float head_yaw_rad)
      : row(walking.posture(0.3f, 0)) {
    row[walking.column("pelvis_lateral")] += shift_m;
    for (const char* joint : {"left_shoulder_abduction", "right_shoulder_abduction"})
      row[walking.column(joint)] += kBreath_rad;
    walking.gait.apply_head_yaw(head_yaw_rad, row);
    apply_avoidance(walking.gait.outline()->columns, avoidance, posture, row);
  }
};

void expect_within_limits(const Walking& walking, const std::vector<float>& row) {
  const std::vector<JointColumn>& columns = walking.model->kinematics.columns();
  for (size_t c = 0; c < columns.size(); ++c) {
    ASSERT_GE(row[c], columns[c].lower - 1e-6f) << columns[c].name;
    ASSERT_LE(row[c], columns[c].upper + 1e-6f) << columns[c].name;
  }
}

/// Returns the bounds of the gait, independent of the standing posture.
RoundBounds round_bounds_of(const Gait& gait) {
  return {gait.sphere_centre_m().z(), gait.sphere_radius_m(), gait.upright_radius_m()};
}

void expect_inside(const Walking& walking, const UpperBodyBounds& upper_bounds,
                   const std::vector<float>& row) {
  const std::vector<PartPose> poses = walking.poses(row);
  std::vector<PartPose> upper(static_cast<size_t>(upper_bounds.kinematics().output_count()));
  const RootFrame root;
  forward_kinematics(upper_bounds.kinematics(), row, {&root, 1}, upper);
  const RoundBounds all = round_bounds_of(walking.gait);
  const std::optional<RootBox> box = upper_bounds.box_within(upper, all, SimdTarget::kBest);
  ASSERT_TRUE(box) << "would not be allowed to stand so";
  for (size_t part = 0; part < poses.size(); ++part)
    for (const Eigen::Vector3f& vertex : walking.model->parts[part].mesh.vertices) {
      const Eigen::Vector3d p = to_isometry(poses[part]) * vertex.cast<double>();
      const std::string& name = walking.model->parts[part].name;
      ASSERT_LE(p.head<2>().norm(), static_cast<double>(all.cylinder_m)) << name;
      ASSERT_LE((p - walking.gait.sphere_centre_m().cast<double>()).norm(),
                static_cast<double>(all.sphere_m))
          << name;
      const bool of_arm =
          name.find("Arm") != std::string::npos || name.find("Hand") != std::string::npos;
      for (int axis = 0; axis < 2 && (of_arm || name == "torso"); ++axis) {
        ASSERT_GE(p[axis], static_cast<double>(box->min_m[axis])) << name;
        ASSERT_LE(p[axis], static_cast<double>(box->max_m[axis])) << name;
      }
    }
}

TEST(StandingPosture, StaysWithinJointsAndBoundsInTransition) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    const UpperBodyBounds upper_bounds(*walking.model, walking.gait.outline()->columns);
    std::vector<StandingPosture> postures = all_means();
    for (uint64_t id = 0; id < 150; ++id) postures.push_back(standing_posture(9, id));
    for (const StandingPosture& posture : postures)
      for (const float share : {0.0f, 0.25f, 0.5f, 0.8f, 1.0f}) {
        SCOPED_TRACE(testing::Message()
                     << "hold " << static_cast<int>(posture.hold) << ", share " << share);
        AvoidancePosture avoidance;
        avoidance.standing = share;
        const bool avoids = unit(random) < 0.5f;
        if (avoids) {
          avoidance.trunk_rad = 1.4f * unit(random) - 0.7f;
          avoidance.arms = {unit(random), unit(random)};
        }
        const float shift_m = unit(random) < 0.5f ? -kMaxShift_m : kMaxShift_m;
        const Stander stander(walking, posture, avoidance, shift_m, unit(random) - 0.5f);
        expect_within_limits(walking, stander.row);
        expect_inside(walking, upper_bounds, stander.row);
        if (testing::Test::HasFatalFailure()) return;
      }
  }
}

TEST(StandingPosture, JoinsHandsOutsideTheTrunk) {
  const Walking& walking = Walking::adult();
  for (uint64_t id = 0; id < 2000; ++id) {
    const StandingPosture posture = standing_posture(4, id);
    AvoidancePosture avoidance;
    avoidance.standing = 1;
    const Stander stander(walking, posture, avoidance, 0, 0);
    const std::vector<PartPose> poses = walking.poses(stander.row);
    std::array<Eigen::AlignedBox3d, 2> hands;
    Eigen::AlignedBox3d trunk;
    for (size_t part = 0; part < poses.size(); ++part) {
      const std::string& name = walking.model->parts[part].name;
      for (const Eigen::Vector3f& vertex : walking.model->parts[part].mesh.vertices) {
        const Eigen::Vector3d p = to_isometry(poses[part]) * vertex.cast<double>();
        if (name == "RightHand") hands[0].extend(p);
        if (name == "leftHand") hands[1].extend(p);
        if (name == "torso") trunk.extend(p);
      }
    }
    SCOPED_TRACE(testing::Message()
                 << "hold " << static_cast<int>(posture.hold) << ", person " << id);
    const bool is_joined = posture.hold == ArmHold::kJoinedLow ||
                           posture.hold == ArmHold::kJoinedHigh ||
                           posture.hold == ArmHold::kBehindBack;
    const double apart_m = std::sqrt(hands[0].squaredExteriorDistance(hands[1]));
    if (is_joined) {
      EXPECT_LT(apart_m, 0.07);
    } else {
      EXPECT_GT(apart_m, 0.1);
    }
    for (const Eigen::AlignedBox3d& hand : hands) EXPECT_FALSE(trunk.contains(hand));
  }
}

/// Arm angles while a person comes to stand, sets out, and reverses in between.
TEST(StandingPosture, ChangesAtLimitedRates) {
  constexpr double kMaxRate_degps = 250,
                   kMaxAcceleration_degps2 = 2000;  // half of the rates in walking
  std::mt19937 random(6);
  for (const float step_s : {1.0f / 30, 1.0f / 60}) {
    double fastest = 0, hardest = 0;
    const auto arms_at = [](const AvoidanceMotion& motion) {
      std::vector<double> angles;
      for (const StandingPosture& posture : all_means())
        for (const auto& arm : posture.arms_rad)
          for (const float angle : arm)
            angles.push_back(static_cast<double>(motion.standing * angle) / kDegree);
      return angles;
    };
    AvoidanceMotion motion;
    std::vector<double> last = arms_at(motion), before = last;
    bool stands = false;
    for (int i = 0; i < 20000; ++i) {
      if (random() % 40 == 0) stands = !stands;
      follow_standing(stands, step_s, motion);
      ASSERT_GE(motion.standing, 0);
      ASSERT_LE(motion.standing, 1);
      const std::vector<double> now = arms_at(motion);
      for (size_t n = 0; n < now.size(); ++n) {
        const double step = static_cast<double>(step_s);
        fastest = std::max(fastest, std::abs(now[n] - last[n]) / step);
        hardest = std::max(hardest, std::abs(now[n] - 2 * last[n] + before[n]) / (step * step));
      }
      before = last;
      last = now;
    }
    std::printf("step of %.4f s: at most %.0f degrees/s and %.0f degrees/s2\n",
                static_cast<double>(step_s), fastest, hardest);
    EXPECT_LT(fastest, kMaxRate_degps);
    EXPECT_LT(hardest, kMaxAcceleration_degps2);
    const auto takes_s = [&](bool comes) {
      AvoidanceMotion from;
      from.standing = comes ? 0 : 1;
      int steps = 0;
      for (; std::abs(from.standing - (comes ? 1.0f : 0.0f)) > 0.05f; ++steps)
        follow_standing(comes, step_s, from);
      return static_cast<double>(static_cast<float>(steps) * step_s);
    };
    EXPECT_NEAR(takes_s(true), 1.4, 0.2);
    EXPECT_NEAR(takes_s(false), 0.85, 0.2);
    for (int i = 0; i < 300; ++i) follow_standing(false, step_s, motion);
    EXPECT_EQ(motion.standing, 0) << "nothing is left of it";
  }
}

TEST(StandingPosture, HasNoEffectAtShareZero) {
  const Walking& walking = Walking::adult();
  for (const float speed_mps : {0.0f, 0.7f, 1.5f}) {
    const std::vector<float> before = walking.posture(0.4f, speed_mps);
    for (uint64_t id = 0; id < 20; ++id) {
      std::vector<float> row = before;
      apply_avoidance(walking.gait.outline()->columns, {}, standing_posture(1, id), row);
      EXPECT_EQ(row, before);
    }
    AvoidancePosture turned;
    turned.trunk_rad = 0.2f;
    turned.arms = {0.3f, 0.9f};
    std::vector<float> row = before, other = before;
    apply_avoidance(walking.gait.outline()->columns, turned, standing_posture(1, 3), row);
    apply_avoidance(walking.gait.outline()->columns, turned, {}, other);
    EXPECT_EQ(row, other);
  }
}

TEST(StandingPosture, HasTheOutlineOfItsArmHold) {
  const Walking& walking = Walking::adult();
  const Outline& outline = *walking.gait.outline();
  ASSERT_EQ(outline.standing.size(), 2 * kArmHoldCount);
  const auto swings = [&](ArmHold hold) -> const LimbOutlines& {
    return outline.standing_sweep(mean_standing_posture(hold, false)).envelope();
  };
  constexpr size_t kAhead = 0, kLeft = 2, kBehind = 4, kRight = 6;
  const LimbOutlines& hanging = swings(ArmHold::kHanging);
  const LimbOutlines& joined = swings(ArmHold::kJoinedHigh);
  EXPECT_GT(joined.arms[0].reaches_m[kAhead], hanging.arms[0].reaches_m[kAhead] + 0.05f);
  EXPECT_LT(joined.arms[0].reaches_m[kRight], hanging.arms[0].reaches_m[kRight]);
  const LimbOutlines& behind = swings(ArmHold::kBehindBack);
  EXPECT_GT(behind.arms[1].reaches_m[kBehind], hanging.arms[1].reaches_m[kBehind] + 0.05f);
  const LimbOutlines& raised = swings(ArmHold::kOneHandRaised);
  EXPECT_GT(raised.arms[0].reaches_m[kAhead], raised.arms[1].reaches_m[kAhead] + 0.1f);
  EXPECT_NEAR(raised.arms[1].reaches_m[kLeft], hanging.arms[1].reaches_m[kLeft], 1e-5f);
}

}  // namespace
}  // namespace throng::standing_arms_test
