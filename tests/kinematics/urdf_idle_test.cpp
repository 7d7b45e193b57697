// What a URDF says to no purpose is skipped and listed, and sizes that only look harmless are
// refused before a parser sees them.
#include "kinematics/urdf_idle.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/errors.h"
#include "kinematics/mesh_path.h"
#include "kinematics/robot.h"

namespace throng {
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

std::string robot(const std::string& in_link) {
  return fmt::format("<robot name='r'>\n<link name='foot'>\n{}\n</link>\n</robot>\n", in_link);
}

std::string shape(const std::string& tag, const std::string& geometry) {
  return fmt::format("<{0}><geometry>{1}</geometry></{0}>", tag, geometry);
}

TEST(UrdfIdle, MarkersWithoutSizeAreSkippedAndListed) {
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

TEST(UrdfIdle, NotesCommandNoTerminal) {
  const Robot read = parse("<robot name='r'><link name='foot'/><\x1b[31mloud/><torn\xff/></robot>");
  EXPECT_THAT(read.notes, Contains(HasSubstr("<\\x1b[31mloud>")));
  EXPECT_THAT(read.notes, Contains(HasSubstr("<torn\\xff>")));
}

TEST(UrdfIdle, WhatHasASurfaceStaysBesideAMarker) {
  const Robot read =
      parse(robot(shape("visual", "<box size='0 0 0'/>") + shape("visual", "<box size='1 2 3'/>")));
  ASSERT_EQ(read.links[0].visual.size(), 1u);
  EXPECT_EQ(read.links[0].visual[0].box_size_m, Eigen::Vector3d(1, 2, 3));
}

TEST(UrdfIdle, APlateAndANegativeSizeAreStillRefused) {
  for (const char* geometry :
       {"<box size='1 1 0'/>", "<box size='0 0 -1'/>", "<sphere radius='-1'/>",
        "<cylinder radius='1' length='0'/>", "<box size='0 0'/>", "<box size='nan 0 0'/>"})
    EXPECT_THAT(complaint_about(robot(shape("visual", geometry))),
                HasSubstr("robot.urdf:3: expected"))
        << geometry;
}

TEST(UrdfIdle, IncompleteInertiaIsSkippedAndListed) {
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

TEST(UrdfIdle, LinesKeepTheirNumbersBehindWhatIsSkipped) {
  EXPECT_THAT(
      complaint_about(robot("<visual>\n<geometry>\n<box size='0 0 0'/>\n</geometry>\n</visual>\n" +
                            shape("visual", "<box size='1 1 -1'/>"))),
      HasSubstr("robot.urdf:8: "));
}

TEST(UrdfIdle, ZeroBytesAtTheEndAreSkippedAndElsewhereRefused) {
  const std::string sound = robot("");
  const Robot read = parse(sound + std::string(3, '\0'));
  EXPECT_THAT(read.notes, Contains("the last 3 bytes are zero: skipped"));
  std::string within = sound;
  within[10] = '\0';
  EXPECT_THAT(complaint_about(within), HasSubstr("zero byte"));
  EXPECT_NE(complaint_about(std::string(5, '\0')), "accepted");
}

TEST(UrdfSize, ATagHasAtMost64AttributesAndNamesOf256Bytes) {
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

TEST(UrdfSize, ARobotHasAtMost16384Shapes) {
  const auto with_shapes = [](int count) {
    std::string shapes;
    for (int i = 0; i < count; ++i) shapes += shape("visual", "<sphere radius='1'/>");
    return robot(shapes);
  };
  EXPECT_EQ(complaint_about(with_shapes(16'384)), "accepted");
  EXPECT_THAT(complaint_about(with_shapes(16'385)), HasSubstr("expected at most 16384 shapes"));
}

TEST(MeshPath, PackagesAreFoundUnderShareOfAnAmentPrefix) {
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

}  // namespace
}  // namespace throng
