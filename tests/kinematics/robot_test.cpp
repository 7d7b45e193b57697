// read_urdf() on valid files, and its errors for anything but files.
#include "kinematics/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "base/errors.h"

namespace throng::robot_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::filesystem::path fixture(const std::string& file) {
  return std::filesystem::path(THRONG_SOURCE_DIR) / "tests/kinematics/fixtures" / file;
}

Robot parse(const std::string& text) { return parse_urdf(text, "robot.urdf"); }

std::vector<std::string> names_of(const std::vector<Link>& links) {
  std::vector<std::string> names;
  for (const Link& link : links) names.push_back(link.name);
  return names;
}

TEST(ReadUrdf, OrdersLinksFromTheRootAndJointsLikeTheirChildren) {
  const Robot robot = read_urdf(fixture("mimic_hand.urdf"));
  EXPECT_EQ(robot.name, "mimic_hand");
  EXPECT_THAT(names_of(robot.links), ElementsAre("palm", "proximal", "middle", "tip", "thumb"));
  for (size_t i = 0; i < robot.joints.size(); ++i) {
    EXPECT_EQ(robot.joints[i].child_link, static_cast<int>(i) + 1);
    EXPECT_LT(robot.joints[i].parent_link, robot.joints[i].child_link);
  }
}

TEST(ReadUrdf, ReadsJointsWithUnitAxesAndLimits) {
  const Robot robot = read_urdf(fixture("skew_arm.urdf"));
  const Joint& lift = robot.joints[1];
  EXPECT_EQ(lift.name, "lift");
  EXPECT_EQ(lift.kind, Joint::Kind::kPrismatic);
  EXPECT_NEAR(lift.axis.norm(), 1, 1e-15);
  EXPECT_NEAR(lift.axis.x() / lift.axis.z(), 0.1, 1e-15);
  EXPECT_EQ(lift.lower, -0.1);
  EXPECT_EQ(lift.upper, 0.4);
  EXPECT_EQ(robot.joints[6].name, "wrist_joint");
  EXPECT_EQ(robot.joints[6].kind, Joint::Kind::kContinuous);
  EXPECT_EQ(robot.joints[6].lower, -std::numbers::pi);
  EXPECT_EQ(robot.joints[6].upper, std::numbers::pi);
  EXPECT_EQ(robot.joints[7].axis, Eigen::Vector3d::UnitX()) << "the default axis of a joint";
}

TEST(ReadUrdf, RotatesOriginsAboutFixedAxesRollPitchYaw) {
  const Robot robot = read_urdf(fixture("skew_arm.urdf"));
  const Eigen::Isometry3d& pose = robot.joints[0].parent_from_joint;
  const Eigen::Matrix3d expected = (Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  EXPECT_LT((pose.linear() - expected).norm(), 1e-15);
  EXPECT_EQ(pose.translation(), Eigen::Vector3d(0.1, -0.2, 0.2));
}

TEST(ReadUrdf, FindsTheLeaderOfAMimicJointAnywhere) {
  const Robot robot = read_urdf(fixture("mimic_hand.urdf"));
  const Joint& tip = robot.joints[2];
  ASSERT_TRUE(tip.mimic);
  EXPECT_EQ(robot.joints[static_cast<size_t>(tip.mimic->joint)].name, "middle_joint");
  EXPECT_EQ(tip.mimic->multiplier, 0.7);
  EXPECT_EQ(tip.mimic->offset, 0.1);
}

TEST(ReadUrdf, ReadsEveryKindOfGeometry) {
  const Robot robot = read_urdf(fixture("wheels.urdf"));
  ASSERT_EQ(robot.links[1].visual.size(), 1u);
  const Geometry& box = robot.links[1].visual[0];
  EXPECT_EQ(box.kind, Geometry::Kind::kBox);
  EXPECT_EQ(box.box_size_m, Eigen::Vector3d(0.6, 0.45, 0.4));
  EXPECT_EQ(box.link_from_geometry.translation(), Eigen::Vector3d(0, 0, 0.25));
  EXPECT_EQ(robot.links[1].mass_kg, 20);
  EXPECT_EQ(robot.links[2].collision[0].kind, Geometry::Kind::kCylinder);
  EXPECT_EQ(robot.links[2].collision[0].radius_m, 0.1);
  EXPECT_EQ(robot.links[2].collision[0].length_m, 0.04);
  EXPECT_EQ(robot.links.back().collision[0].kind, Geometry::Kind::kSphere);
}

TEST(ReadUrdf, ResolvesPackagesAndScalesOfAHumanoid) {
  const Robot robot = read_urdf(fixture("humanoid_description/urdf/humanoid.urdf"));
  int meshes = 0;
  for (const Link& link : robot.links)
    for (const Geometry& geometry : link.visual) {
      if (geometry.kind != Geometry::Kind::kMesh) continue;
      ++meshes;
      EXPECT_TRUE(std::filesystem::exists(geometry.mesh_file)) << geometry.mesh_file;
      if (link.name == "right_thigh") {
        EXPECT_EQ(geometry.mesh_scale, Eigen::Vector3d(0.001, -0.001, 0.001));
      }
    }
  EXPECT_EQ(meshes, 8);
}

TEST(ReadUrdf, NotesUnusedTagsOnceEach) {
  const Robot robot = read_urdf(fixture("humanoid_description/urdf/humanoid.urdf"));
  EXPECT_THAT(robot.notes, testing::UnorderedElementsAre(
                               HasSubstr("<transmission> x25"), HasSubstr("<gazebo> x2"),
                               HasSubstr("<ros2_control> x1"),
                               HasSubstr("<self_collision_checking> x1: not under"),
                               HasSubstr("<material>"), HasSubstr("<inertial>"),
                               HasSubstr("<dynamics> x27"), HasSubstr("<safety_controller> x27")));
}

TEST(ReadUrdf, RejectsAnythingButFiles) {
  EXPECT_THROW(read_urdf(fixture("")), InputError);
  EXPECT_THROW(read_urdf(fixture("no_such.urdf")), InputError);
  EXPECT_THROW(read_urdf("/dev/zero"), InputError);
}

TEST(ReadUrdf, AcceptsBomCrlfCommentsCdataAndEntities) {
  const Robot robot = parse(
      "\xef\xbb\xbf<?xml version=\"1.0\"?>\r\n<!DOCTYPE robot>\r\n<!-- <link> -->\r\n"
      "<robot name='R&amp;D'>\r\n<link name=\"a&lt;b\"/><gazebo><![CDATA[ </x> "
      "]]></gazebo></robot>\r\n");
  EXPECT_EQ(robot.name, "R&D");
  EXPECT_EQ(robot.links[0].name, "a<b");
}

TEST(ReadUrdf, AcceptsLineBreaksAndTabsBetweenNumbers) {
  const Robot robot = parse(
      "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='fixed'>"
      "<parent link='a'/><child link='b'/><origin xyz='1\n\t2 3 '/></joint></robot>");
  EXPECT_EQ(robot.joints[0].parent_from_joint.translation(), Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace throng::robot_test
