// Forward kinematics equals KDL's, for every SIMD target and any grouping.
#include <gtest/gtest.h>

#include <cstring>
#include <numeric>

#include "base/random.h"
#include "kinematics/kinematics.h"
#include "tests/kinematics/kdl_oracle.h"
#include "tests/same_bits.h"

namespace throng::forward_kinematics_test {
namespace {

constexpr uint64_t kSeed = 20240611;

std::filesystem::path path_of(const std::string& file) {
  return std::filesystem::path(THRONG_SOURCE_DIR) / file;
}

std::vector<int> all_links(const Robot& robot) {
  std::vector<int> links(robot.links.size());
  std::iota(links.begin(), links.end(), 0);
  return links;
}

/// Postures within the limits, random roots and scales.
struct Crowd {
  std::vector<float> postures;
  std::vector<RootFrame> roots;
};

Crowd random_crowd(const FlatModel& model, int avatars) {
  Crowd crowd;
  for (int i = 0; i < avatars; ++i) {
    const RandomKey key{kSeed, static_cast<uint64_t>(i), 0, Purpose::kGaitPhase};
    uint32_t draw = 0;
    for (const JointColumn& column : model.columns())
      crowd.postures.push_back(static_cast<float>(random_uniform(
          key, static_cast<double>(column.lower), static_cast<double>(column.upper), draw++)));
    Eigen::Vector4d q;
    for (int k = 0; k < 4; ++k) q[k] = random_uniform(key, -1, 1, draw++);
    RootFrame root;
    root.world_from_root = Eigen::Quaterniond(q.normalized()).cast<float>();
    root.scale = static_cast<float>(random_uniform(key, 0.8, 1.2, draw++));
    crowd.roots.push_back(root);
  }
  return crowd;
}

std::vector<PartPose> poses_of(const FlatModel& model, const Crowd& crowd, SimdTarget target) {
  std::vector<PartPose> poses(crowd.roots.size() * static_cast<size_t>(model.output_count()));
  forward_kinematics(model, crowd.postures, crowd.roots, poses, target);
  return poses;
}

class ForwardKinematics : public testing::TestWithParam<const char*> {
 protected:
  ForwardKinematics() : robot_(read_urdf(path_of(GetParam()))), model_(robot_, all_links(robot_)) {}

  Robot robot_;
  FlatModel model_;
};

TEST_P(ForwardKinematics, AgreesWithKdlInRandomPostures) {
  const Crowd crowd = random_crowd(model_, 10000);
  const auto poses = poses_of(model_, crowd, SimdTarget::kBest);
  KdlOracle oracle(robot_);
  double worst_m = 0;
  double worst_rad = 0;
  for (size_t i = 0; i < crowd.roots.size(); ++i) {
    oracle.set(crowd.postures.data() + i * static_cast<size_t>(model_.column_count()));
    const Eigen::Matrix3d world_from_root =
        crowd.roots[i].world_from_root.cast<double>().toRotationMatrix();
    for (size_t link = 0; link < robot_.links.size(); ++link) {
      const Eigen::Isometry3d expected = oracle.root_from(robot_.links[link].name);
      const Eigen::Isometry3d found = to_isometry(poses[i * robot_.links.size() + link]);
      const Eigen::Vector3d position =
          world_from_root * expected.translation() * static_cast<double>(crowd.roots[i].scale);
      worst_m = std::max(worst_m, (found.translation() - position).norm());
      // For small angles the chord between two rotations, measured by the sine, is the angle.
      const Eigen::Matrix3d error =
          found.linear().transpose() * world_from_root * expected.linear();
      const Eigen::Vector3d sine(error(2, 1) - error(1, 2), error(0, 2) - error(2, 0),
                                 error(1, 0) - error(0, 1));
      ASSERT_GT(error.trace(), 2.9);
      worst_rad = std::max(worst_rad, 0.5 * sine.norm());
    }
  }
  RecordProperty("worst_m", std::to_string(worst_m));
  RecordProperty("worst_rad", std::to_string(worst_rad));
  EXPECT_LT(worst_m, 1e-5) << "seed " << kSeed;
  EXPECT_LT(worst_rad, 1e-5) << "seed " << kSeed;
}

TEST_P(ForwardKinematics, EqualsTheScalarLoopOnAllTargets) {
  const Crowd crowd = random_crowd(model_, 100);
  const auto expected = poses_of(model_, crowd, SimdTarget::kScalar);
  for (const SimdTarget target : simd_targets_of_this_machine()) {
    const auto found = poses_of(model_, crowd, target);
    for (size_t i = 0; i < expected.size(); ++i)
      ASSERT_TRUE(same_bits(expected[i], found[i]))
          << name_of(target) << ", pose " << i << ", seed " << kSeed;
  }
}

TEST_P(ForwardKinematics, DoesNotDependOnGrouping) {
  const Crowd crowd = random_crowd(model_, 37);
  const auto expected = poses_of(model_, crowd, SimdTarget::kScalar);
  const size_t columns = static_cast<size_t>(model_.column_count());
  const size_t outputs = static_cast<size_t>(model_.output_count());
  for (const SimdTarget target : simd_targets_of_this_machine())
    for (size_t group = 1; group <= 37; ++group)
      for (size_t first = 0; first < 37; first += group) {
        const size_t count = std::min(group, 37 - first);
        // One pose more than needed, to detect writes behind the end.
        std::vector<PartPose> found(count * outputs + 1);
        std::memset(static_cast<void*>(&found.back()), 0x5a, sizeof(PartPose));
        const PartPose sentinel = found.back();
        forward_kinematics(model_,
                           std::span(crowd.postures).subspan(first * columns, count * columns),
                           std::span(crowd.roots).subspan(first, count),
                           std::span(found).first(count * outputs), target);
        ASSERT_TRUE(same_bits(found.back(), sentinel));
        found.pop_back();
        ASSERT_TRUE(same_bits(std::span<const PartPose>(found),
                              std::span(expected).subspan(first * outputs, count * outputs)))
            << name_of(target) << ", groups of " << group << ", seed " << kSeed;
      }
}

TEST_P(ForwardKinematics, DoesNotDependOnOtherOutputs) {
  const Crowd crowd = random_crowd(model_, 9);
  const auto expected = poses_of(model_, crowd, SimdTarget::kScalar);
  for (int link = 0; link < model_.output_count(); ++link) {
    const FlatModel alone(robot_, std::span(&link, 1));
    const auto found = poses_of(alone, crowd, SimdTarget::kBest);
    for (size_t i = 0; i < found.size(); ++i) {
      const PartPose& one = expected[i * robot_.links.size() + static_cast<size_t>(link)];
      // Constant parts are merged differently; the numbers agree up to rounding.
      const double off = (to_isometry(one).matrix() - to_isometry(found[i]).matrix()).norm();
      ASSERT_LT(off, 1e-5) << "link " << robot_.links[static_cast<size_t>(link)].name;
    }
  }
}

TEST_P(ForwardKinematics, KeepsOriginsWithinTheirReach) {
  const Crowd crowd = random_crowd(model_, 1000);
  const auto poses = poses_of(model_, crowd, SimdTarget::kBest);
  for (size_t i = 0; i < poses.size(); ++i) {
    const size_t output = i % robot_.links.size();
    const float scale = crowd.roots[i / robot_.links.size()].scale;
    const double distance = to_isometry(poses[i]).translation().norm();
    ASSERT_LE(distance, static_cast<double>(model_.reach_m()[output] * scale))
        << robot_.links[output].name << ", seed " << kSeed;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Robots, ForwardKinematics,
    testing::Values("avatars/models/adult/adult.urdf",
                    "tests/kinematics/fixtures/humanoid_description/urdf/humanoid.urdf",
                    "tests/kinematics/fixtures/wheels.urdf",
                    "tests/kinematics/fixtures/skew_arm.urdf",
                    "tests/kinematics/fixtures/mimic_hand.urdf",
                    "tests/kinematics/fixtures/single.urdf", "tests/kinematics/fixtures/bush.urdf"),
    [](const auto& test) { return std::filesystem::path(test.param).stem().string(); });

}  // namespace
}  // namespace throng::forward_kinematics_test
