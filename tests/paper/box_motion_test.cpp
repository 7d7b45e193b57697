// Tests the box of the paper: objects stay inside, keep their speed and depend on the seed only.
#include "scenes/motion/box_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/errors.h"

namespace throng::box_motion_test {
namespace {

constexpr uint64_t kSeed = 7;

BoxDynamics world_of(uint64_t seed, double edge_m = 2) {
  const std::vector<double> radii_m = {0.1, 0.3, 0.05};
  BoxOptions options;
  options.seed = seed;
  options.edge_m = edge_m;
  return BoxDynamics::of_kinds(options, radii_m, 40, 4);
}

TEST(BoxDynamics, KeepsObjectsInside) {
  BoxDynamics world = world_of(kSeed);
  const std::vector<double> radii_m = {0.1, 0.3, 0.05};
  for (int frame = 0; frame < 5000; ++frame) {
    for (size_t i = 0; i < world.size(); ++i) {
      const Eigen::Vector3d& p = world.positions_m()[i];
      const double r = radii_m[i % 3];
      const double out = std::max((world.low_m() - p).maxCoeff(), (p - world.high_m()).maxCoeff());
      ASSERT_LE(out + r, 1e-12) << "object " << i << ", frame " << frame << ", seed " << kSeed;
      ASSERT_LE(p.norm(), world.reach_m());
    }
    world.step();
  }
}

/// Advances one step and returns its rotations.
std::vector<Eigen::AngleAxisd> next_turns(BoxDynamics& world) {
  const std::vector<Eigen::Quaterniond> before(world.orientations().begin(),
                                               world.orientations().end());
  world.step();
  std::vector<Eigen::AngleAxisd> turns;
  for (size_t i = 0; i < world.size(); ++i)
    turns.emplace_back(world.orientations()[i] * before[i].conjugate());
  return turns;
}

TEST(BoxDynamics, KeepsSpeedAndSpin) {
  BoxDynamics world = world_of(kSeed);
  std::vector<double> speeds2;
  const std::vector<Eigen::AngleAxisd> first = next_turns(world);
  for (const Eigen::Vector3d& v : world.velocities_mps()) speeds2.push_back(v.squaredNorm());
  for (int frame = 0; frame < 5000; ++frame) world.step();
  const std::vector<Eigen::AngleAxisd> last = next_turns(world);
  for (size_t i = 0; i < world.size(); ++i) {
    EXPECT_EQ(world.velocities_mps()[i].squaredNorm(), speeds2[i]) << "object " << i;
    const Eigen::Vector3d change =
        last[i].angle() * last[i].axis() - first[i].angle() * first[i].axis();
    EXPECT_LT(change.norm(), 1e-12) << "object " << i;
  }
}

TEST(BoxDynamics, MovesByVelocityAndSpin) {
  const std::vector<Eigen::AngleAxisd> turns = [] {
    BoxDynamics twin = world_of(kSeed, 50);
    return next_turns(twin);
  }();
  BoxDynamics world = world_of(kSeed, 50);  // so wide that no object meets a wall within a second
  const std::vector<Eigen::Vector3d> start(world.positions_m().begin(), world.positions_m().end());
  const std::vector<Eigen::Quaterniond> turned(world.orientations().begin(),
                                               world.orientations().end());
  const std::vector<Eigen::Vector3d> flying(world.velocities_mps().begin(),
                                            world.velocities_mps().end());
  for (int frame = 0; frame < 60; ++frame) world.step();
  size_t checked = 0;
  for (size_t i = 0; i < world.size(); ++i) {
    if (world.velocities_mps()[i] != flying[i]) continue;  // met a wall
    ++checked;
    EXPECT_LT((world.positions_m()[i] - start[i] - flying[i]).norm(), 1e-12) << "object " << i;
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(60 * turns[i].angle(), turns[i].axis()) *
                                      turned[i]);
    EXPECT_LT(expected.angularDistance(world.orientations()[i]), 1e-7) << "object " << i;
    EXPECT_NEAR(world.orientations()[i].norm(), 1, 1e-15);
  }
  EXPECT_GT(checked, 20u);
}

TEST(BoxDynamics, KeepsEveryFourthObjectStatic) {
  BoxDynamics world = world_of(kSeed);
  const std::vector<Eigen::AngleAxisd> turns = next_turns(world);
  for (size_t i = 0; i < world.size(); ++i) {
    const bool still = i % 4 == 3;
    EXPECT_EQ(world.velocities_mps()[i].norm() == 0, still) << "object " << i;
    EXPECT_EQ(turns[i].angle() < 1e-12, still) << "object " << i;
  }
}

TEST(BoxDynamics, DependsOnTheSeedOnly) {
  BoxDynamics one = world_of(1), again = world_of(1), other = world_of(2);
  for (int frame = 0; frame < 100; ++frame) {
    one.step();
    again.step();
    other.step();
  }
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one.positions_m()[i], again.positions_m()[i]);
    EXPECT_EQ(one.orientations()[i].coeffs(), again.orientations()[i].coeffs());
    EXPECT_NE(one.positions_m()[i], other.positions_m()[i]);
  }
}

TEST(BoxDynamics, PosesMatchOrientations) {
  BoxDynamics world = world_of(kSeed);
  world.step();
  for (size_t i = 0; i < world.size(); ++i) {
    const Eigen::Isometry3d pose = to_isometry(world.pose(i));
    EXPECT_LT((pose.linear() - world.orientations()[i].toRotationMatrix()).cwiseAbs().maxCoeff(),
              1e-7);
    EXPECT_LT((pose.translation() - world.positions_m()[i]).cwiseAbs().maxCoeff(), 3e-7);
  }
}

TEST(BoxDynamics, RejectsAnObjectThatDoesNotFit) { EXPECT_THROW(world_of(1, 0.6), InputError); }

}  // namespace
}  // namespace throng::box_motion_test
