// `throng info` describes valid files and rejects others in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/apps/cli.h"

namespace throng::info_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::string kVertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string kFaces = "0 2 1\n0 1 3\n0 3 2\n1 2 3\n";
const std::string kFacesFromOne = "1 3 2\n1 2 4\n1 4 3\n2 3 4\n";

std::string with_crlf(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? "\r\n" : std::string(1, c);
  return out;
}

struct TriText {
  std::string name;
  std::string text;
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
void PrintTo(const TriText& tri, std::ostream* out) { *out << tri.name; }

class GoodTri : public testing::TestWithParam<TriText> {};

TEST_P(GoodTri, IsReadAsATetrahedron) {
  const ScratchFolder folder;
  write_file(folder / "body.tri", GetParam().text);
  const Outcome outcome = shell("throng info body.tri", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out, testing::ContainsRegex("4 +vertices|vertices *:? *4"));
}

INSTANTIATE_TEST_SUITE_P(
    Dialects, GoodTri,
    testing::Values(TriText{"CountsThenLists", "4\n" + kVertices + "4\n" + kFaces},
                    TriText{"Keyword", "TRI\n4 4\n" + kVertices + kFaces},
                    TriText{"CountsOnOneLine", "4 4\n" + kVertices + kFaces},
                    TriText{"FromOne", "4\n" + kVertices + "4\n" + kFacesFromOne},
                    TriText{"Comments", "# a body\n4\n" + kVertices + "4 # faces\n" + kFaces},
                    TriText{"CarriageReturns", with_crlf("4\n" + kVertices + "4\n" + kFaces)},
                    TriText{"Scientific", "4\n0e0 0 0\n1e+0 0 0\n0 10.0E-1 0\n0 0 1\n4\n" + kFaces},
                    TriText{"ByteOrderMark",
                            "\xef\xbb\xbf"
                            "4\n" +
                                kVertices + "4\n" + kFaces},
                    TriText{"PointCloud", "4\n" + kVertices}),
    [](const auto& each) { return each.param.name; });

class BadTri : public testing::TestWithParam<TriText> {};

TEST_P(BadTri, IsRejectedInOneLine) {
  const ScratchFolder folder;
  write_file(folder / "body.tri", GetParam().text);
  const Outcome outcome = shell("throng info body.tri", folder);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("body.tri"));
  EXPECT_THAT(outcome.err, HasSubstr("expected"));
}

INSTANTIATE_TEST_SUITE_P(
    Defects, BadTri,
    testing::Values(TriText{"Empty", ""}, TriText{"NoVertices", "0\n0\n"},
                    TriText{"ShortVertices", "4\n0 0 0\n1 0 0\n"},
                    TriText{"ShortFaces", "4\n" + kVertices + "4\n0 2 1\n"},
                    TriText{"IndexOutOfRange", "4\n" + kVertices + "1\n0 1 7\n"},
                    TriText{"NegativeIndex", "4\n" + kVertices + "1\n0 1 -1\n"},
                    TriText{"NotANumber", "4\n0 0 nan\n1 0 0\n0 1 0\n0 0 1\n4\n" + kFaces},
                    TriText{"NegativeCount", "-4\n" + kVertices + "4\n" + kFaces},
                    TriText{"HugeCount", "999999999999\n" + kVertices},
                    TriText{"TrailingRubbish", "4\n" + kVertices + "4\n" + kFaces + "and more\n"},
                    TriText{"Binary", std::string("\x7f"
                                                  "ELF\0\0\1\2",
                                                  8)}),
    [](const auto& each) { return each.param.name; });

TEST(Info, DescribesEveryFixtureOfTheReader) {
  const ScratchFolder folder;
  const std::filesystem::path fixtures = THRONG_SOURCE_DIR "/tests/avatars/fixtures/tri";
  int described = 0;
  for (const auto& entry : std::filesystem::directory_iterator(fixtures)) {
    const Outcome outcome = shell("throng info '" + entry.path().string() + "'", folder);
    EXPECT_EQ(outcome.exit_code, 0) << entry.path().filename() << ": " << outcome.err;
    ++described;
  }
  EXPECT_GE(described, 8);
}

TEST(Info, RejectsAFolder) {
  const ScratchFolder folder;
  const Outcome outcome = shell("mkdir folder.tri; throng info folder.tri", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
}

TEST(Info, ListsTheFifteenPartsOfTheBundledAdult) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng info " + repository("avatars/models/adult/adult.urdf"), folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* part :
       {"head.tri", "torso.tri", "pelvis.tri", "upperRightLeg.tri", "upperLeftLeg.tri",
        "lowerRightLeg.tri", "lowerLeftLeg.tri", "leftFoot.tri", "rightFoot.tri",
        "upperLeftArm.tri", "upperRightArm.tri", "lowerLeftArm.tri", "lowerRightArm.tri",
        "leftHand.tri", "RightHand.tri"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
}

TEST(Info, RejectsABrokenRobotWithItsLine) {
  const ScratchFolder folder;
  write_file(
      folder / "loop.urdf",
      "<robot name='r'>\n<link name='a'/>\n<link name='b'/>\n"
      "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\n"
      "<joint name='k' type='fixed'><parent link='b'/><child link='b'/></joint>\n</robot>\n");
  const Outcome outcome = shell("throng info loop.urdf", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("loop.urdf:"));
}

TEST(Info, DescribesTheBundledScenes) {
  const ScratchFolder folder;
  const Outcome list = shell("throng scenes", folder);
  EXPECT_EQ(list.exit_code, 0) << list.err;
  for (const std::string name : {"plaza", "corridor"}) {
    EXPECT_THAT(list.out, HasSubstr(name + " "));
    const Outcome outcome = shell("throng info " + name, folder);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(name + ":"));
    EXPECT_THAT(outcome.out, HasSubstr("Groups:"));
  }
}

std::string scene_of(const std::string& model) {
  return "ground: {min_m: [-9, -9], max_m: [9, 9]}\ngroups:\n- {name: g, count: 2, model: " +
         model +
         ", spawn: {min_m: [-8, -8], max_m: [8, 8]}, goals: [{min_m: [2, 2], max_m: [5, 5]}]}\n";
}

TEST(Info, CountsWallsAndPiecesInOneLine) {
  const ScratchFolder folder;
  std::string text =
      "ground: {polygon: [[0, 0], [30, 0], [30, 10], [20, 10], [20, 20], [0, 20]], wall_height_m: "
      "2.5}\ngroups:\n- {name: g, count: 2, spawn: {min_m: [1, 1], max_m: [8, 8]}, goals: [{min_m: "
      "[2, 2], max_m: [5, 5]}]}\nobstacles:\n- {name: counter, kind: polygon, polygon: [[12, 2], "
      "[16, 2], [16, 5], [15, 5], [15, 3], [12, 3]], top_m: 1.1}\n";
  const auto pillars = [](int count) {
    std::string out;
    for (int i = 0; i < count; ++i)
      out += "- {name: pillar-" + std::to_string(i) + ", kind: cylinder, position_m: [" +
             std::to_string(1 + i % 18) + ", " + std::to_string(12 + 2 * (i / 18)) +
             "], diameter_m: 0.2, height_m: 3}\n";
    return out;
  };
  write_file(folder / "few.yaml", text + pillars(29));
  const std::string few = shell("throng info few.yaml", folder).out;
  EXPECT_THAT(few, HasSubstr("\nObstacles:\n"));
  EXPECT_THAT(few, HasSubstr("\n  walls: 6 along the edges of the ground, 2.5 m high\n"));
  EXPECT_THAT(few, HasSubstr("\n  counter: polygon 4 x 3 x 1.1 m at (14, 3.5), in 2 pieces\n"));
  EXPECT_THAT(few, HasSubstr("\n  pillar-28: cylinder 0.2 x 0.2 x 3 m at (11, 14)\n"));
  EXPECT_THAT(few, testing::Not(HasSubstr(" more\n")));
  EXPECT_THAT(few, testing::Not(HasSubstr("wall 2")));
  write_file(folder / "many.yaml", text + pillars(40));
  const std::string many = shell("throng info many.yaml", folder).out;
  EXPECT_THAT(many, HasSubstr("\n  and 11 more\n"));
  EXPECT_THAT(many, testing::Not(HasSubstr("pillar-29")));
}

TEST(Info, RecognisesAUrdfByItsContent) {
  const ScratchFolder folder;
  const std::string urdf =
      "<robot name=\"crate\"><link name=\"base\"><collision><geometry><box size=\"1 1 1\"/>"
      "</geometry></collision></link></robot>";
  const std::string prolog = "<?xml version=\"1.0\"?>\n<!-- " + std::string(9000, '=') + " -->\n";
  for (const char* name : {"robot_description.xml", "robot.txt", "robot", "robot.csv", "robot.URDF",
                           "robot.urdf.xacro", "robot.yaml", "robot.tri"})
    for (const std::string& before : {std::string(), prolog, "\xef\xbb\xbf" + prolog}) {
      SCOPED_TRACE(name);
      write_file(folder / name, before + urdf);
      const Outcome info = shell(std::string("throng info ") + name, folder);
      EXPECT_EQ(info.exit_code, 0) << info.err;
      EXPECT_THAT(info.out, HasSubstr("model 'crate': 1 links"));
      const Outcome run = shell(std::string("throng run ") + name, folder);
      EXPECT_EQ(run.exit_code, 2) << run.err;
      EXPECT_THAT(run.err, HasSubstr("expected a scene, found a URDF; "));
    }
  write_file(folder / "scene.yaml", scene_of("robot_description.xml"));
  const Outcome run = shell("throng run scene.yaml --seconds 0.1 --lcm off --log off", folder);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(shell("throng bench --model robot.txt --avatars 20 --frames 1 --engines none", folder)
                .exit_code,
            0);
  write_file(folder / "world.xml", "<sdf><robot/></sdf>");
  EXPECT_THAT(shell("throng info world.xml", folder).err, HasSubstr("found XML"));
}

TEST(Info, SuggestsExpandingAXacroFile) {
  const ScratchFolder folder;
  write_file(
      folder / "robot.urdf.xacro",
      "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:arg name=\"a\"/></robot>");
  write_file(folder / "robot.xml", "<robot name=\"r\">\n<link name=\"${prefix}base\"/></robot>");
  write_file(folder / "scene.yaml", scene_of("robot.xml"));
  for (const char* command : {"throng info robot.urdf.xacro", "throng info robot.xml",
                              "throng run scene.yaml --lcm off --log off"}) {
    const Outcome outcome = shell(command, folder);
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_THAT(outcome.err, HasSubstr(":2: expected plain URDF, found ")) << command;
    EXPECT_THAT(outcome.err, HasSubstr("expand it first: xacro FILE")) << command;
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  }
}

TEST(Info, NotesWhatAUrdfLeavesOpen) {
  const ScratchFolder folder;
  const auto part = [](const std::string& name, const std::string& shape) {
    return "<link name=\"" + name + "\"><collision><geometry>" + shape +
           "</geometry></collision></link>";
  };
  const std::string torso =
      repository("tests/kinematics/fixtures/humanoid_description/meshes/torso.dae");
  shell("sed 's/Z_UP/Y_UP/' " + torso + " >y.dae; grep -q Y_UP y.dae", folder);
  write_file(folder / "arm.urdf",
             "<robot name=\"arm\">" + part("base", "<mesh filename=\"y.dae\"/>") +
                 part("hand", "<mesh filename=\"y.dae\"/>") +
                 "<joint name=\"elbow\" type=\"revolute\"><parent link=\"base\"/><child "
                 "link=\"hand\"/></joint></robot>");
  write_file(folder / "scene.yaml", scene_of("arm.urdf"));
  const std::string joint = "revolute joints without <limit> are read as continuous ones: 'elbow'";
  const std::string mesh = "mesh 'y.dae' states Y_UP, which is ignored";
  const Outcome info = shell("throng info arm.urdf", folder);
  EXPECT_THAT(info.out, HasSubstr("\nnote: " + joint)) << info.err;
  EXPECT_THAT(info.out, HasSubstr("\nnote: " + mesh));
  const Outcome run =
      shell("throng run scene.yaml --seconds 0.1 --lcm off --log off --json run.json", folder);
  EXPECT_THAT(run.err, HasSubstr("note: model 'arm': " + joint));
  EXPECT_THAT(run.err, HasSubstr("note: model 'arm': " + mesh));
  EXPECT_EQ(run.err.find(mesh), run.err.rfind(mesh)) << "noted once";
  EXPECT_THAT(read_file(folder / "run.json"), HasSubstr(joint));
}

}  // namespace
}  // namespace throng::info_test
