// `throng info` reads what is out there, says what it is, and refuses the rest in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/apps/cli.h"

namespace throng {
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

TEST_P(GoodTri, IsATetrahedron) {
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

TEST_P(BadTri, IsRefusedInOneLine) {
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

TEST(Info, EveryFixtureOfTheReaderIsDescribed) {
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

TEST(Info, FolderIsNoMesh) {
  const ScratchFolder folder;
  const Outcome outcome = shell("mkdir folder.tri; throng info folder.tri", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
}

TEST(Info, BundledAdultHasItsFifteenParts) {
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

TEST(Info, BrokenRobotIsRefusedWithItsLine) {
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

TEST(Info, BundledScenesAreListedAndDescribed) {
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

}  // namespace
}  // namespace throng
