// Parts of a URDF without effect are skipped and listed; excessive sizes are rejected.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/errors.h"
#include "kinematics/mesh_path.h"
#include "kinematics/plain_urdf.h"
#include "kinematics/robot.h"
#include "kinematics/xml_scan.h"

namespace throng::urdf_ignored_test {
namespace {

using testing::Contains;
using testing::HasSubstr;

Robot parse(const std::string& text) { return parse_urdf(text, "robot.urdf"); }

std::string complaint_about(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<std::string> assumptions_of(const std::string& text) {
  std::vector<std::string> assumptions;
  parse_urdf(text, "robot.urdf", &assumptions);
  return assumptions;
}

std::string robot(const std::string& in_link) {
  return fmt::format("<robot name='r'>\n<link name='foot'>\n{}\n</link>\n</robot>\n", in_link);
}

std::string shape(const std::string& tag, const std::string& geometry) {
  return fmt::format("<{0}><geometry>{1}</geometry></{0}>", tag, geometry);
}

TEST(UrdfIgnored, SkipsAndListsMarkersWithoutSize) {
  for (const char* geometry :
       {"<box size='0 0 0'/>", "<box size='0.0 -0 1'/>", "<sphere radius='0'/>",
        "<cylinder radius='0' length='0'/>", "<cylinder radius='0.0' length='0.2'/>"})
    for (const char* tag : {"visual", "collision"}) {
      const Robot read = parse(robot(shape(tag, geometry)));
      EXPECT_TRUE(read.links[0].visual.empty() && read.links[0].collision.empty()) << geometry;
      EXPECT_THAT(read.notes,
                  Contains(HasSubstr(fmt::format("<{}> of link 'foot', line 3: skipped", tag))));
    }
}

TEST(UrdfIgnored, EscapesControlCharactersInNotes) {
  const Robot read = parse("<robot name='r'><link name='foot'/><\x1b[31mloud/><torn\xff/></robot>");
  EXPECT_THAT(read.notes, Contains(HasSubstr("<\\x1b[31mloud>")));
  EXPECT_THAT(read.notes, Contains(HasSubstr("<torn\\xff>")));
}

TEST(UrdfIgnored, KeepsSurfacesNextToMarkers) {
  const Robot read =
      parse(robot(shape("visual", "<box size='0 0 0'/>") + shape("visual", "<box size='1 2 3'/>")));
  ASSERT_EQ(read.links[0].visual.size(), 1u);
  EXPECT_EQ(read.links[0].visual[0].box_size_m, Eigen::Vector3d(1, 2, 3));
}

TEST(UrdfIgnored, RejectsPlatesAndNegativeSizes) {
  for (const char* geometry :
       {"<box size='1 1 0'/>", "<box size='0 0 -1'/>", "<sphere radius='-1'/>",
        "<cylinder radius='1' length='0'/>", "<box size='0 0'/>", "<box size='nan 0 0'/>"})
    EXPECT_THAT(complaint_about(robot(shape("visual", geometry))),
                HasSubstr("robot.urdf:3: expected"))
        << geometry;
}

TEST(UrdfIgnored, SkipsAndListsIncompleteInertia) {
  const char* const mass = "<mass value='2'/>";
  for (const std::string& inertia :
       {std::string(mass), fmt::format("{}<inertia ixx='1' iyy='1'/>", mass),
        fmt::format("{}<inertia/>", mass), std::string(""),
        std::string("<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>")}) {
    const Robot read = parse(robot("<inertial>" + inertia + "</inertial>"));
    EXPECT_THAT(read.notes, Contains(HasSubstr("<inertial> of link 'foot', line 3: skipped")))
        << inertia;
  }
  const Robot whole =
      parse(robot("<inertial><mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
                  "izz='1'/></inertial>"));
  EXPECT_EQ(whole.links[0].mass_kg, 2);
}

TEST(UrdfIgnored, KeepsLineNumbersAfterSkippedTags) {
  EXPECT_THAT(
      complaint_about(robot("<visual>\n<geometry>\n<box size='0 0 0'/>\n</geometry>\n</visual>\n" +
                            shape("visual", "<box size='1 1 -1'/>"))),
      HasSubstr("robot.urdf:8: "));
}

TEST(UrdfIgnored, SkipsZeroBytesAtTheEndOnly) {
  const std::string sound = robot("");
  const Robot read = parse(sound + std::string(3, '\0'));
  EXPECT_THAT(read.notes, Contains("the last 3 bytes are zero: skipped"));
  std::string within = sound;
  within[10] = '\0';
  EXPECT_THAT(complaint_about(within), HasSubstr("zero byte"));
  EXPECT_NE(complaint_about(std::string(5, '\0')), "accepted");
}

const std::string kBox = "<geometry><box size='1 1 1'/></geometry>";

/// Returns two links with a box each and a joint between them.
std::string jointed(const std::string& type, const std::string& in_joint) {
  return fmt::format(
      "<robot name='r'>\n<link name='a'><collision>{0}</collision></link>\n"
      "<link name='b'><collision>{0}</collision></link>\n"
      "<joint name='j' type='{1}'><parent link='a'/><child link='b'/>{2}</joint>\n</robot>",
      kBox, type, in_joint);
}

TEST(UrdfIgnored, AcceptsDefectsThatNoShapeDependsOn) {
  const std::string collision = "<collision>" + kBox + "</collision>";
  for (const std::string& text : {
           robot("<visual>" + kBox + "<material/></visual>"),
           robot("<visual>" + kBox + "<material><color rgba='1 0 0'/></material></visual>"),
           robot("<visual>" + kBox + "<material name=''><color/></material></visual>"),
           robot("<visual>" + kBox + "<material name='unknown'/></visual>"),
           robot("<visual name=''>" + kBox + "</visual>"),
           robot(collision + "<inertial><origin xyz='nan 0 0'/><mass value='1'/><inertia ixx='x' "
                             "ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"),
           robot(collision + "<visual><geometry><plane normal='0 0 1'/></geometry></visual>"),
           robot(collision + "<visual/>"),
           robot(collision + shape("visual", "<mesh filename='http://x/a.stl'/>")),
           robot(collision + shape("visual", "<mesh filename=''/>")),
           robot(collision + shape("visual", "<box size='1 1 -1'/>")),
           "<robot name='r'><material name='m'/><material name='m'/><material/><link name='a'>" +
               collision + "</link></robot>",
           "<robot name='r' version='9'><link name='a'>" + collision +
               "</link><transmission/><gazebo reference='b'><plugin file='$(find x)'/></gazebo>"
               "<sensor/><group name='g'/></robot>",
           jointed("continuous", "<limit effort='inf' velocity='x'/>"),
           jointed("continuous", "<limit lower='-inf' upper='inf' effort='1' velocity='1'/>"),
           jointed("revolute", "<limit lower='-1' upper='1'/>"),
           jointed("revolute", "<limit lower='-1' upper='1' effort='' velocity='inf'/>"),
           jointed("continuous", "<dynamics/><calibration rising='x'/><safety_controller/>"),
           jointed("fixed", "<axis xyz='0 0 0'/><limit/><mimic/><dynamics/>"),
       }) {
    EXPECT_EQ(complaint_about(text), "accepted") << text;
    if (complaint_about(text) != "accepted") continue;
    const Robot read = parse(text);
    const Link& link = read.links[0];
    EXPECT_EQ(link.collision.size() + link.visual.size(), 1u) << text;
  }
  EXPECT_THAT(
      parse(robot(collision + shape("visual", "<plane/>"))).notes,
      Contains("<visual> of link 'foot', line 3: skipped in favour of <collision>: expected "
               "<mesh>, <box>, <cylinder>, <sphere> or <capsule>, found <plane>"));
  EXPECT_THAT(complaint_about(robot("<visual/>")), HasSubstr("robot.urdf:3: expected"));
}

TEST(UrdfIgnored, NamesUnnamedRobotsAfterTheirFile) {
  for (const char* attribute : {"", "name=''", "name='  '"}) {
    const Robot read = parse_urdf(fmt::format("<robot {}><link name='a'/></robot>", attribute),
                                  "models/humanoid.urdf");
    EXPECT_EQ(read.name, "humanoid") << attribute;
    EXPECT_THAT(read.notes, Contains(HasSubstr("called 'humanoid'"))) << attribute;
  }
  EXPECT_EQ(parse_urdf("<robot name='a&#10;b'><link name='a'/></robot>", "x.urdf").name, "a\\x0ab");
}

/// Returns a box `base` with a joint above it.
std::string freed(const std::string& type, const std::string& in_world = "",
                  const std::string& more = "") {
  return fmt::format(
      "<robot name='r'><link name='world'>{}</link><link name='base'>{}</link>{}"
      "<joint name='free' type='{}'><parent link='world'/><child link='base'/>"
      "<origin xyz='0 0 3'/></joint></robot>",
      in_world, "<collision>" + kBox + "</collision>", more, type);
}

TEST(UrdfIgnored, CutsOffTheWorldAboveAFreeJoint) {
  const std::string frames =
      "<link name='map'/><joint name='above' type='planar'><parent link='map'/><child "
      "link='world'/></joint><link name='camera'/><joint name='beside' type='fixed'><parent "
      "link='world'/><child link='camera'/></joint>";
  const std::string arm =
      "<link name='arm'/><joint name='shoulder' type='continuous'><parent link='base'/><child "
      "link='arm'/></joint>";
  for (const char* type : {"floating", "planar"})
    for (const std::string& more : {std::string(), frames, arm, frames + arm}) {
      SCOPED_TRACE(type + more);
      const Robot read = parse(freed(type, "", more));
      EXPECT_EQ(read.links[0].name, "base");
      EXPECT_EQ(read.links.size(), more.ends_with(arm) ? 2u : 1u);
      EXPECT_EQ(read.joints.size() + 1, read.links.size());
      EXPECT_THAT(read.notes, Contains(HasSubstr("the robot's root is 'base', and moves freely")));
    }
  EXPECT_THAT(complaint_about(freed("floating", "<collision>" + kBox + "</collision>")),
              HasSubstr("found 'floating': it has several degrees of freedom"));
  EXPECT_THAT(complaint_about(freed("planar", "<visual>" + kBox + "</visual>")),
              HasSubstr("found 'planar': it has several degrees of freedom"));
  // Two robots in one file.
  EXPECT_THAT(complaint_about(freed("floating", "",
                                    "<link name='other'><collision>" + kBox +
                                        "</collision></link><joint name='too' type='floating'>"
                                        "<parent link='world'/><child link='other'/></joint>")),
              HasSubstr("it has several degrees of freedom"));
  // A frame below a robot.
  const Robot hung = parse(freed("fixed", "",
                                 "<link name='target'/><joint name='any' type='floating'><parent "
                                 "link='base'/><child link='target'/></joint>"));
  EXPECT_EQ(hung.links.size(), 2u);
  EXPECT_THAT(hung.notes, Contains(HasSubstr("skipped with all links from 'target' on")));
}

TEST(UrdfIgnored, ReadsCapsules) {
  const Robot read =
      parse(robot("<collision><origin xyz='0 0 1'/><geometry><capsule radius='0.5' length='2'/>"
                  "</geometry></collision>" +
                  shape("collision", "<cylinder radius='0.25' length='1'/>") +
                  shape("visual", "<capsule radius='0.1' length='0'/>")));
  ASSERT_EQ(read.links[0].collision.size(), 2u);
  const Geometry& capsule = read.links[0].collision[0];
  EXPECT_EQ(capsule.kind, Geometry::Kind::kCapsule);
  EXPECT_EQ(capsule.radius_m, 0.5);
  EXPECT_EQ(capsule.length_m, 2);
  EXPECT_EQ(capsule.link_from_geometry.translation().z(), 1);
  EXPECT_EQ(read.links[0].collision[1].kind, Geometry::Kind::kCylinder);
  EXPECT_EQ(read.links[0].visual[0].kind, Geometry::Kind::kCapsule);
  EXPECT_TRUE(parse(robot(shape("collision", "<capsule radius='0' length='1'/>")))
                  .links[0]
                  .collision.empty());
}

TEST(UrdfIgnored, ReadsASphericalJointAsThree) {
  const std::string text =
      "<robot name='r'><link name='a'/><link name='ball_x'/><link name='c'/>"
      "<joint name='ball' type='spherical'><parent link='a'/><child link='ball_x'/><origin xyz='0 "
      "0 "
      "1'/><axis xyz='0 0 0'/></joint><joint name='ball_y' type='fixed'><parent link='ball_x'/>"
      "<child link='c'/></joint></robot>";
  const Robot read = parse(text);
  ASSERT_EQ(read.joints.size(), 4u);
  ASSERT_EQ(read.links.size(), 5u);
  const std::array names{"ball_x", "ball_yy", "ball_z"};
  for (int i = 0; i < 3; ++i) {
    const Joint& joint = read.joints[static_cast<size_t>(i)];
    EXPECT_EQ(joint.name, names[static_cast<size_t>(i)]);
    EXPECT_EQ(joint.kind, Joint::Kind::kContinuous);
    EXPECT_EQ(joint.axis, Eigen::Vector3d::Unit(i));
    EXPECT_EQ(joint.parent_from_joint.translation().z(), i == 0 ? 1 : 0);
    EXPECT_EQ(joint.parent_link, i);
    EXPECT_EQ(joint.child_link, i + 1);
  }
  EXPECT_EQ(read.links[1].name, "ball_xx");
  EXPECT_EQ(read.links[3].name, "ball_x");
  EXPECT_EQ(read.joints[3].parent_link, 3);
  EXPECT_THAT(assumptions_of(text), testing::ElementsAre(HasSubstr("'ball' (line 1)")));
}

TEST(UrdfIgnored, ReadsQuaternionsLikeAngles) {
  const auto turned = [](const std::string& by) {
    return parse(jointed("fixed", fmt::format("<origin xyz='1 2 3' {}/>", by))).joints[0];
  };
  EXPECT_LT((turned("quat_xyzw='0 0 2 2'").parent_from_joint.matrix() -
             turned("rpy='0 0 1.5707963267948966'").parent_from_joint.matrix())
                .norm(),
            1e-12);
}

TEST(UrdfIgnored, ListsAssumptionsForMissingLimits) {
  const auto read = [](const std::string& type, const std::string& in_joint) {
    return parse(jointed(type, in_joint));
  };
  const Robot turning = read("revolute", "");
  EXPECT_EQ(turning.joints[0].kind, Joint::Kind::kContinuous);
  EXPECT_THAT(assumptions_of(jointed("revolute", "")),
              testing::ElementsAre("revolute joints without <limit> are read as continuous ones: "
                                   "'j' (line 4)"));
  const Robot sliding = read("prismatic", "");
  EXPECT_EQ(sliding.joints[0].lower, 0);
  EXPECT_EQ(sliding.joints[0].upper, 0);
  EXPECT_THAT(assumptions_of(jointed("prismatic", "")),
              testing::ElementsAre("prismatic joints without <limit> stay at 0 m: 'j' (line 4)"));
  for (const char* type : {"revolute", "prismatic"})
    EXPECT_THAT(assumptions_of(jointed(type, "<limit effort='1' velocity='1'/>")),
                testing::ElementsAre("joints without lower and upper in <limit> do not move, "
                                     "because both are 0: 'j' (line 4)"));
  EXPECT_THAT(assumptions_of(jointed("revolute", "<limit upper='1'/>")), testing::IsEmpty());
  EXPECT_THAT(assumptions_of(jointed("continuous", "")), testing::IsEmpty());
}

TEST(UrdfSize, LimitsAttributesTo64AndNamesTo256Bytes) {
  const auto with_attributes = [](int count) {
    std::string text = "<x";
    for (int i = 0; i < count; ++i) text += fmt::format(" a{}='1'", i);
    return "<robot name='r'>\n<link name='a'/>\n" + text + "/></robot>";
  };
  EXPECT_EQ(complaint_about(with_attributes(64)), "accepted");
  EXPECT_THAT(complaint_about(with_attributes(65)),
              HasSubstr("robot.urdf:3: expected at most 64 attributes in <x>, found more"));
  EXPECT_THAT(complaint_about(with_attributes(100'000)), HasSubstr("at most 64 attributes"));
  EXPECT_THAT(
      complaint_about("<robot name='r'><link name='a'/><" + std::string(257, 'n') + "/></robot>"),
      HasSubstr("names of at most 256 bytes"));
}

TEST(UrdfSize, LimitsShapesTo16384) {
  const auto with_shapes = [](int count) {
    std::string shapes;
    for (int i = 0; i < count; ++i) shapes += shape("visual", "<sphere radius='1'/>");
    return robot(shapes);
  };
  EXPECT_EQ(complaint_about(with_shapes(16'384)), "accepted");
  EXPECT_THAT(complaint_about(with_shapes(16'385)), HasSubstr("expected at most 16384 shapes"));
}

TEST(MeshPath, FindsPackagesUnderShareOfAnAmentPrefix) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / fmt::format("throng_ament_{}", ::getpid());
  fs::create_directories(folder / "install/share/my_robot/meshes");
  std::ofstream(folder / "install/share/my_robot/meshes/arm.stl") << "solid";
  const std::string prefixes = fmt::format("/nowhere:{}", (folder / "install").string());
  ::setenv("AMENT_PREFIX_PATH", prefixes.c_str(), 1);
  EXPECT_EQ(resolve_mesh("package://my_robot/meshes/arm.stl", "/somewhere/robot.urdf"),
            folder / "install/share/my_robot/meshes/arm.stl");
  EXPECT_EQ(resolve_mesh("package://other/arm.stl", "/somewhere/robot.urdf"),
            fs::path("package://other/arm.stl"));
  ::unsetenv("AMENT_PREFIX_PATH");
  EXPECT_EQ(resolve_mesh("package://my_robot/meshes/arm.stl", "/somewhere/robot.urdf"),
            fs::path("package://my_robot/meshes/arm.stl"));
  fs::remove_all(folder);
}

TEST(MeshPath, ReadsEveryFormOfUri) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / fmt::format("throng uris {}", ::getpid());
  fs::create_directories(folder / "robot_description/meshes");
  fs::create_directories(folder / "robot_description/urdf");
  for (const char* name : {"arm.stl", "my arm.stl", "100%.stl", "a%20b.stl"})
    std::ofstream(folder / "robot_description/meshes" / name) << "solid";
  const fs::path urdf = folder / "robot_description/urdf/robot.urdf";
  const std::string here = folder.string();
  std::string coded = here;
  for (size_t at; (at = coded.find(' ')) != std::string::npos;) coded.replace(at, 1, "%20");
  for (const auto& [uri, name] : std::vector<std::pair<std::string, std::string>>{
           {"package://robot_description/meshes/arm.stl", "arm.stl"},
           {"package://robot_description//meshes/arm.stl", "arm.stl"},
           {"package:///robot_description/meshes/arm.stl", "arm.stl"},
           {"package:/robot_description/meshes/arm.stl", "arm.stl"},
           {"package:///meshes/arm.stl", "arm.stl"},
           {"package://" + here + "/robot_description/meshes/arm.stl", "arm.stl"},
           {"PACKAGE://robot_description/meshes/my%20arm.stl", "my arm.stl"},
           {"package://robot_description/meshes/my arm.stl", "my arm.stl"},
           {"model://robot_description/meshes/%6dy%20arm%2Estl", "my arm.stl"},
           {"package://robot_description/meshes/100%.stl", "100%.stl"},
           {"package://robot_description/meshes/100%25.stl", "100%.stl"},
           {"package://robot_description/meshes/a%20b.stl", "a%20b.stl"},
           {"file://" + here + "/robot_description/meshes/my arm.stl", "my arm.stl"},
           {"file://" + coded + "/robot_description/meshes/my%20arm.stl", "my arm.stl"},
           {"file://localhost" + coded + "/robot_description/meshes/arm.stl", "arm.stl"},
           {"file:" + coded + "/robot_description/meshes/arm.stl", "arm.stl"},
           {"file://../meshes/arm.stl", "arm.stl"},
           {"../meshes/my%20arm.stl", "my arm.stl"},
           {"../meshes/my arm.stl", "my arm.stl"},
           {"../meshes/a%20b.stl", "a%20b.stl"},
           {here + "/robot_description/meshes/100%.stl", "100%.stl"}})
    EXPECT_EQ(resolve_mesh(uri, urdf).lexically_normal(),
              folder / "robot_description/meshes" / name)
        << uri;
  EXPECT_EQ(resolve_mesh("package://other/a%20b.stl", urdf), fs::path("package://other/a b.stl"));
  EXPECT_THROW(resolve_mesh("http://x/arm.stl", urdf), InputError);
  fs::remove_all(folder);
}

TEST(RootTag, IsFoundAfterAnyProlog) {
  EXPECT_EQ(root_tag_of("<robot name='r'>"), "robot");
  EXPECT_EQ(root_tag_of("\xef\xbb\xbf \r\n<?xml version='1.0'?><!-- <sdf> -->\n<!DOCTYPE robot>"
                        "<robot>"),
            "robot");
  EXPECT_EQ(root_tag_of("<sdf><robot/>"), "sdf");
  EXPECT_EQ(root_tag_of("<robots/>"), "robots");
  for (const char* other : {"", "robot", "{\"a\": \"<robot>\"}", "<!-- <robot>", "<robo", "<"})
    EXPECT_EQ(root_tag_of(other), "") << other;
}

}  // namespace
}  // namespace throng::urdf_ignored_test
