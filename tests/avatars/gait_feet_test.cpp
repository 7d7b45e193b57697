// Feet of a walking person on the ground, with real vertices and real kinematics.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "avatars/gait/gait_curves.h"
#include "tests/avatars/gait_fixture.h"

namespace throng::gait_feet_test {
namespace {

using test::Walking;

constexpr std::array<float, 6> kSpeeds = {0.5f, 0.8f, 1.0f, 1.34f, 1.6f, 2.0f};

TEST(GaitFeet, StayWithin1CmOfTheGround) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    for (const float speed :
         {0.0f, 0.01f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f, 1.34f, 1.6f, 2.0f, 2.2f, 3.0f})
      for (int i = 0; i < 601; ++i) {
        const float phase = static_cast<float>(i) / 601;
        const std::vector<PartPose> poses = walking.poses(walking.posture(phase, speed));
        double low = std::numeric_limits<double>::infinity();
        for (const size_t foot : {walking.right_foot, walking.left_foot})
          low = std::min(low, walking.lowest(foot, poses[foot]).first.z());
        ASSERT_NEAR(low, 0, 0.001) << "at " << speed << " m/s, phase " << phase;
      }
  }
}

// Returns how far the foot's contact slides: each lowest vertex against its previous place.
double slide_m(const Walking& walking, float speed, bool right) {
  constexpr int kSteps = 1000;
  const double stride = static_cast<double>(walking.gait.stride_length_m(speed, 1));
  const double mps = static_cast<double>(speed);
  const double per_root = stride_per_sqrt_speed(walking.style);
  const double leg = stride * stride / (per_root * per_root * mps);
  const int lift_off = static_cast<int>(stance_fraction(mps / leg, walking.style) * kSteps);
  const size_t foot = right ? walking.right_foot : walking.left_foot;
  const std::vector<Eigen::Vector3f>& vertices = walking.model->parts[foot].mesh.vertices;
  double slid = 0;
  Eigen::Vector3d previous = Eigen::Vector3d::Zero();
  size_t contact = 0;
  for (int i = 0; i <= lift_off; ++i) {
    const double own = static_cast<double>(i) / kSteps;
    const double phase = right ? own : own + (own < 0.5 ? 0.5 : -0.5);
    const std::vector<PartPose> poses =
        walking.poses(walking.posture(static_cast<float>(phase), speed));
    const Eigen::Vector3d root(stride * own, 0, 0);
    if (i > 0) {
      const Eigen::Vector3d is = to_isometry(poses[foot]) * vertices[contact].cast<double>() + root;
      slid += (is - previous).head<2>().norm();
    }
    const auto [lowest, vertex] = walking.lowest(foot, poses[foot]);
    previous = lowest + root;
    contact = vertex;
  }
  return slid;
}

TEST(GaitFeet, SlideLessThan1CmPerStep) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    for (const float speed : kSpeeds)
      for (const bool right : {true, false})
        EXPECT_LT(slide_m(walking, speed, right), 0.005)
            << (right ? "right" : "left") << " foot at " << speed << " m/s";
  }
}

TEST(GaitFeet, StayPlantedAtACrawl) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    for (const float speed : {0.02f, 0.05f, 0.1f, 0.2f, 0.3f, 0.4f})
      EXPECT_LT(slide_m(walking, speed, true), 0.005) << "at " << speed << " m/s";
  }
}

TEST(GaitFeet, ClearTheGroundInSwing) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    for (const float speed : kSpeeds)
      for (int i = 0; i < 200; ++i) {
        // The right foot swings from toe-off, at most 0.69 here, to heel strike at 1.
        const float phase = 0.72f + 0.26f * static_cast<float>(i) / 200;
        const std::vector<PartPose> poses = walking.poses(walking.posture(phase, speed));
        const double low = walking.lowest(walking.right_foot, poses[walking.right_foot]).first.z();
        ASSERT_GT(low, phase < 0.9f ? 0.002 : -0.0005) << "at " << speed << " m/s, phase " << phase;
      }
  }
}

TEST(GaitFeet, LandOnTheHeelAndLeaveWithTheToes) {
  const Walking& walking = Walking::adult();
  for (const float speed : {0.8f, 1.34f, 2.0f}) {
    const auto contact_x = [&](float phase) {
      const std::vector<PartPose> poses = walking.poses(walking.posture(phase, speed));
      const size_t vertex = walking.lowest(walking.right_foot, poses[walking.right_foot]).second;
      return walking.model->parts[walking.right_foot].mesh.vertices[vertex].x();
    };
    EXPECT_LT(contact_x(0.01f), 0) << "heel, behind the ankle, at " << speed << " m/s";
    EXPECT_GT(contact_x(0.55f), 0.1f) << "toes, well before the ankle, at " << speed << " m/s";
  }
}

TEST(GaitFeet, StandFlatAndHipWidthApart) {
  const Walking& walking = Walking::adult();
  const std::vector<PartPose> poses = walking.poses(walking.posture(0, 0));
  for (const size_t foot : {walking.right_foot, walking.left_foot}) {
    const Eigen::Isometry3d pose = to_isometry(poses[foot]);
    EXPECT_NEAR(walking.lowest(foot, poses[foot]).first.z(), 0, 1e-4);
    EXPECT_GT(pose.linear()(2, 2), std::cos(0.01)) << "sole tilted";
    EXPECT_NEAR(std::abs(pose.translation().y()), 0.085, 0.02);
  }
}

}  // namespace
}  // namespace throng::gait_feet_test
