// Every defect of a URDF is rejected with its line and the reason. Alone, urdfdom accepts a third
// of these without a message and crashes on some.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.h"
#include "kinematics/robot.h"

namespace throng::urdf_defects_test {
namespace {

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

/// A two-link robot with one of its lines replaced. Line 1 is <robot>.
struct Lines {
  std::string link_a = R"(<link name="a"/>)";
  std::string link_b = R"(<link name="b"/>)";
  std::string type = "revolute";
  std::string ends = R"(<parent link="a"/><child link="b"/>)";
  std::string origin = R"(<origin xyz="0 0 1" rpy="0 0 0"/>)";
  std::string axis = R"(<axis xyz="0 0 1"/>)";
  std::string limit = R"(<limit lower="-1" upper="1" effort="1" velocity="1"/>)";
  std::string more = "";

  std::string text() const {
    return fmt::format(
        "<robot name=\"r\">\n{}\n{}\n<joint name=\"j\" type=\"{}\">\n{}\n{}\n{}\n{}\n</joint>\n{}\n"
        "</robot>\n",
        link_a, link_b, type, ends, origin, axis, limit, more);
  }
};

struct Defect {
  const char* name;
  std::string text;
  const char* complaint;
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
void PrintTo(const Defect& defect, std::ostream* out) { *out << defect.name; }

class UrdfDefects : public testing::TestWithParam<Defect> {};

TEST_P(UrdfDefects, AreRejectedWithLineAndReason) {
  EXPECT_THAT(complaint_about(GetParam().text), HasSubstr(GetParam().complaint));
}

TEST(UrdfDefects, AreAddedToAValidRobot) { EXPECT_EQ(complaint_about(Lines{}.text()), "accepted"); }

std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& inner = "", const std::string& type = "continuous") {
  return fmt::format(
      R"(<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/>{}</joint>)", name, type,
      parent, child, inner);
}

std::string with_link_c(const std::string& joint_text) {
  return fmt::format("<link name='c'/>{}", joint_text);
}

std::string collision(const std::string& shape) {
  return fmt::format(R"(<link name="a"><collision><geometry>{}</geometry></collision></link>)",
                     shape);
}

std::string mass(const std::string& value) {
  return fmt::format(
      R"(<link name="a"><inertial><mass value="{}"/>)"
      R"(<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>)",
      value);
}

INSTANTIATE_TEST_SUITE_P(
    Tree, UrdfDefects,
    testing::Values(
        Defect{"two_parents",
               Lines{.more = fmt::format("<link name='c'/>\n{}{}", joint("k", "a", "c"),
                                         joint("l", "b", "c"))}
                   .text(),
               "robot.urdf:11: expected one parent for each link, found two for 'c': joints 'k' "
               "and 'l'"},
        Defect{"self_loop", Lines{.ends = R"(<parent link="a"/><child link="a"/>)"}.text(),
               "robot.urdf:4: expected a joint between two links"},
        Defect{"detached_loop",
               Lines{.more = fmt::format("<link name='c'/><link name='d'/>\n{}{}",
                                         joint("k", "c", "d"), joint("l", "d", "c"))}
                   .text(),
               "expected every link below the root 'a', found a loop of joints above 'c'"},
        Defect{"all_in_a_loop", Lines{.more = joint("k", "b", "a")}.text(),
               "expected a root link, found none"},
        Defect{"two_roots", Lines{.more = "<link name=\"c\"/>"}.text(),
               "robot.urdf:10: expected one root link, found two: 'a' and 'c'"},
        Defect{"no_link", "<robot name=\"r\"/>", "expected at least one <link>"},
        Defect{"unknown_parent", Lines{.ends = R"(<parent link="A"/><child link="b"/>)"}.text(),
               "robot.urdf:5: expected the name of a <link>, found 'A' (did you mean 'a'?)"},
        Defect{"no_child", Lines{.ends = R"(<parent link="a"/>)"}.text(),
               "robot.urdf:4: expected <child link=...> in <joint>"},
        Defect{"link_twice", Lines{.link_b = R"(<link name="a"/>)"}.text(),
               "robot.urdf:3: expected unique link names, found 'a' again, first on line 2"},
        Defect{"joint_twice", Lines{.more = with_link_c(joint("j", "b", "c"))}.text(),
               "robot.urdf:10: expected unique joint names"},
        Defect{"empty_link_name", Lines{.link_a = R"(<link name=""/>)"}.text(),
               "robot.urdf:2: expected a name for this <link>, found an empty one"},
        Defect{"blank_link_name", Lines{.link_a = R"(<link name="  "/>)"}.text(), "robot.urdf:2"},
        Defect{"no_link_name", Lines{.link_a = R"(<link/>)"}.text(),
               "robot.urdf:2: expected an attribute 'name' in <link>, found none"},
        Defect{"long_name", Lines{.link_a = fmt::format("<link name='{:x>200}'/>", "")}.text(),
               "robot.urdf:2: expected a name for this <link>, found one of 200 bytes, more "
               "than 120"},
        Defect{"newline_in_name", Lines{.link_a = "<link name=\"a&#10;b\"/>"}.text(),
               "control character"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Joints, UrdfDefects,
    testing::Values(
        Defect{"zero_axis", Lines{.axis = R"(<axis xyz="0 0 0"/>)"}.text(),
               "robot.urdf:7: expected a joint axis that is not zero, found '0 0 0'"},
        Defect{"nan_axis", Lines{.axis = R"(<axis xyz="0 nan 1"/>)"}.text(),
               "robot.urdf:7: expected 3 finite numbers in xyz=, found '0 nan 1'"},
        Defect{"infinite_origin", Lines{.origin = R"(<origin xyz="0 inf 1"/>)"}.text(),
               "robot.urdf:6"},
        Defect{"overflowing_origin", Lines{.origin = R"(<origin xyz="0 1e999 1"/>)"}.text(),
               "robot.urdf:6"},
        Defect{"origin_of_two", Lines{.origin = R"(<origin xyz="0 1"/>)"}.text(),
               "robot.urdf:6: expected 3 finite numbers in xyz=, found '0 1'"},
        Defect{"decimal_comma", Lines{.origin = R"(<origin xyz="0,5 1 0"/>)"}.text(),
               "found '0,5 1 0'"},
        Defect{"huge_origin", Lines{.origin = R"(<origin xyz="0 0 1e6"/>)"}.text(),
               "at most 10000 in xyz="},
        Defect{"lower_above_upper",
               Lines{.limit = R"(<limit lower="2" upper="1" effort="1" velocity="1"/>)"}.text(),
               "robot.urdf:8: expected lower <= upper, found lower 2, upper 1"},
        Defect{"nan_limit",
               Lines{.limit = R"(<limit lower="nan" upper="1" effort="1" velocity="1"/>)"}.text(),
               "robot.urdf:8: expected a finite number in lower="},
        Defect{"turned_twice",
               Lines{.origin = R"(<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>)"}.text(),
               "robot.urdf:6: expected rpy= or quat_xyzw= in <origin>, found both"},
        Defect{"quaternion_of_zeros", Lines{.origin = R"(<origin quat_xyzw="0 0 0 0"/>)"}.text(),
               "robot.urdf:6: expected a quaternion that is not zero"},
        Defect{"quaternion_of_three", Lines{.origin = R"(<origin quat_xyzw="0 0 1"/>)"}.text(),
               "robot.urdf:6: expected 4 finite numbers in quat_xyzw="},
        Defect{"floating", Lines{.type = "floating"}.text(),
               "robot.urdf:4: expected fixed, revolute, continuous or prismatic joints, found "
               "'floating': "
               "it has several degrees of freedom"},
        Defect{"planar", Lines{.type = "planar"}.text(), "found 'planar': it has several degrees"},
        Defect{"unknown_type", Lines{.type = "revolut"}.text(),
               "found 'revolut' (did you mean 'revolute'?)"},
        Defect{
            "mimics_an_unknown_joint",
            Lines{.limit =
                      R"(<limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="x"/>)"}
                .text(),
            "robot.urdf:8: expected the name of a <joint> to mimic, found 'x'"},
        Defect{
            "mimics_itself",
            Lines{.limit =
                      R"(<limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="j"/>)"}
                .text(),
            "robot.urdf:8: expected a mimic chain that ends at a free joint, found a cycle "
            "through 'j'"},
        Defect{
            "mimics_in_a_circle",
            Lines{.limit =
                      R"(<limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="k"/>)",
                  .more = with_link_c(joint("k", "b", "c", R"(<mimic joint="j"/>)"))}
                .text(),
            "a cycle through"},
        Defect{
            "mimics_a_fixed_joint",
            Lines{.limit =
                      R"(<limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="k"/>)",
                  .more = with_link_c(joint("k", "b", "c", "", "fixed"))}
                .text(),
            "expected a joint that moves to mimic, found 'k', which is fixed"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Links, UrdfDefects,
    testing::Values(
        Defect{"negative_mass", Lines{.link_a = mass("-1")}.text(),
               "robot.urdf:2: expected a mass that is not negative, found '-1'"},
        Defect{"nan_mass", Lines{.link_a = mass("nan")}.text(),
               "robot.urdf:2: expected a finite number"},
        Defect{"flat_box", Lines{.link_a = collision(R"(<box size="1 0 1"/>)")}.text(),
               "robot.urdf:2: expected a positive size of <box>, found '1 0 1'"},
        Defect{"negative_sphere", Lines{.link_a = collision(R"(<sphere radius="-1"/>)")}.text(),
               "a positive radius of <sphere>"},
        Defect{"cylinder_without_length",
               Lines{.link_a = collision(R"(<cylinder radius="1"/>)")}.text(),
               "an attribute 'length' in <cylinder>"},
        Defect{"plane", Lines{.link_a = collision(R"(<plane normal="0 0 1"/>)")}.text(),
               "expected <mesh>, <box>, <cylinder>, <sphere> or <capsule>, found <plane>"},
        Defect{"negative_capsule",
               Lines{.link_a = collision(R"(<capsule radius="1" length="-1"/>)")}.text(),
               "a length of <capsule> that is not negative, found '-1'"},
        Defect{"capsule_without_radius",
               Lines{.link_a = collision(R"(<capsule length="1"/>)")}.text(),
               "an attribute 'radius' in <capsule>"},
        Defect{"no_shape", Lines{.link_a = collision("")}.text(),
               "<geometry> with a shape in <collision>"},
        Defect{"mesh_without_name", Lines{.link_a = collision(R"(<mesh filename=""/>)")}.text(),
               "a file name for this <mesh>"},
        Defect{"zero_scale",
               Lines{.link_a = collision(R"(<mesh filename="a.stl" scale="1 1 0"/>)")}.text(),
               "a mesh scale that is not zero, found '1 1 0'"},
        Defect{"mesh_from_the_web",
               Lines{.link_a = collision(R"(<mesh filename="http://x/a.stl"/>)")}.text(),
               "robot.urdf:2: expected a mesh path, file://, package:// or model://"}),
    [](const auto& test) { return test.param.name; });

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

std::string chain(int links) {
  std::string text = "<robot name='r'>\n<link name='l0'/>\n";
  for (int i = 1; i < links; ++i)
    text +=
        fmt::format("<link name='l{}'/>\n{}\n", i,
                    joint(fmt::format("j{}", i), fmt::format("l{}", i - 1), fmt::format("l{}", i)));
  return text.append("</robot>");
}

INSTANTIATE_TEST_SUITE_P(
    Text, UrdfDefects,
    testing::Values(
        Defect{"empty", "", "robot.urdf:1: expected an XML element, found none"},
        Defect{"no_xml", "hello", "expected an XML element, found none"},
        Defect{"binary",
               std::string("\x7f"
                           "ELF\0\0",
                           6),
               "found a binary or UTF-16 file"},
        Defect{"not_a_robot", "<sdf version=\"1.6\"/>", "robot.urdf:1: expected <robot>"},
        Defect{"xacro", "<robot name=\"r\"><xacro:include filename=\"x\"/></robot>",
               "found <xacro:include>; expand it first: xacro FILE > robot.urdf"},
        Defect{"xacro_without_a_name",
               "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:arg "
               "name=\"a\"/></robot>",
               "robot.urdf:2: expected plain URDF, found <xacro:arg>; expand it first: xacro FILE"},
        Defect{"xacro_by_another_prefix",
               "<robot xmlns:x=\"http://www.ros.org/wiki/xacro\" name=\"r\">\n<x:macro/></robot>",
               "robot.urdf:2: expected plain URDF, found <x:macro>; expand it first: xacro FILE"},
        Defect{"xacro_in_a_number", Lines{.origin = R"(<origin xyz="${height} 0 0"/>)"}.text(),
               "robot.urdf:6: expected plain URDF, found xyz='${height} 0 0'; expand it first: "
               "xacro FILE"},
        Defect{"xacro_in_the_name", "<robot name=\"$(arg name)\"><link name=\"a\"/></robot>",
               "found name='$(arg name)'; expand it first: xacro FILE"},
        Defect{"xacro_in_a_file_name",
               Lines{.link_a = collision(R"(<mesh filename="$(find pkg)/a.stl"/>)")}.text(),
               "found filename='$(find pkg)/a.stl'; expand it first: xacro FILE"},
        Defect{"unclosed", "<robot name=\"r\">\n<link name=\"a\">\n</robot>",
               "robot.urdf:3: expected </link>, which closes line 2, found </robot>"},
        Defect{"cut_off", "<robot name=\"r\">\n<link name=\"a\"/>",
               "robot.urdf:1: expected </robot> to close this tag, found the end of the file"},
        Defect{"cut_in_a_tag", "<robot name=\"r\">\n<link na", "robot.urdf:2"},
        Defect{"cut_in_a_value", "<robot name=\"r", "a closing quote for 'name'"},
        Defect{"quote_in_an_attributes_name", "<robot name=\"r\" a\"b=\"c\"/>",
               "robot.urdf:1: expected '=' after the attribute 'a'"},
        Defect{"cut_in_a_comment", "<robot name=\"r\"><!-- ", "'-->' to close '<!--'"},
        Defect{"two_robots", "<robot name=\"r\"><link name=\"a\"/></robot><robot/>",
               "one outermost element"},
        Defect{"nested_200000_deep", repeated("<a>", 200000),
               "expected tags nested at most 64 deep"},
        Defect{"nested_in_a_robot", repeated("<robot name='r'>", 1).append(repeated("<a>", 200000)),
               "robot.urdf:1: expected tags nested at most 64 deep"},
        Defect{"a_million_elements",
               repeated("<robot name='r'>", 1).append(repeated("<a/>", 1000000)),
               "at most 200000 elements"},
        Defect{"a_chain_of_1000_links", chain(1000), "expected chains of at most 256 joints"},
        Defect{"10000_links", chain(10000), "expected at most 2048 links, found more"},
        Defect{"17_megabytes", std::string(17u << 20, ' '), "expected at most 16777216 bytes"}),
    [](const auto& test) { return test.param.name; });

TEST(UrdfDefects, ExcludeTheLongestAllowedChain) {
  const Robot robot = parse(chain(257));
  EXPECT_EQ(robot.joints.size(), 256u);
}

}  // namespace
}  // namespace throng::urdf_defects_test
