// Logs after a run: checked, repaired, described and drawn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/apps/cli.h"

namespace throng::log_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Log : public testing::Test {
 protected:
  void SetUp() override {
    const Outcome run =
        shell("throng run corridor --seconds 0.5 --lcm off --log run.lcmlog", folder_);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  ScratchFolder folder_;
};

TEST_F(Log, IsSound) {
  const Outcome check = shell("throng check run.lcmlog", folder_);
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  EXPECT_THAT(check.out, StartsWith("run.lcmlog: sound\n"));
}

TEST_F(Log, IsRepairedIfTorn) {
  const std::string whole = read_file(folder_ / "run.lcmlog");
  write_file(folder_ / "torn.lcmlog", whole.substr(0, whole.size() * 2 / 3));
  const Outcome torn = shell("throng check torn.lcmlog --repair mended.lcmlog", folder_);
  EXPECT_EQ(torn.exit_code, 1) << torn.out;
  EXPECT_THAT(torn.out, HasSubstr("problem"));
  const std::string mended = read_file(folder_ / "mended.lcmlog");
  EXPECT_GT(mended.size(), 0u);
  EXPECT_TRUE(whole.starts_with(mended)) << "the sound part is not copied byte for byte";
  const Outcome check = shell("throng check mended.lcmlog", folder_);
  EXPECT_EQ(check.exit_code, 1) << "the rest of the run is missing";
  EXPECT_THAT(check.out, StartsWith("mended.lcmlog: sound, but cut off\n"));
  EXPECT_THAT(check.out, Not(HasSubstr("problem")));
}

TEST_F(Log, IsNotChangedByRepair) {
  const std::string whole = read_file(folder_ / "run.lcmlog");
  const Outcome onto_itself = shell("throng check run.lcmlog --repair run.lcmlog", folder_);
  EXPECT_EQ(onto_itself.exit_code, 2) << onto_itself.err;
  EXPECT_TRUE(read_file(folder_ / "run.lcmlog") == whole);
}

TEST_F(Log, IsDescribed) {
  const Outcome info = shell("throng info run.lcmlog", folder_);
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("corridor"));
  EXPECT_THAT(info.out, HasSubstr("THRONG_EVENTS"));
}

TEST_F(Log, IsDrawn) {
  const std::string line = "throng render run.lcmlog --frame 20 --width 320 --height 200 --out ";
  for (const char* name : {"a.png", "b.png"}) {
    const Outcome render = shell(line + name, folder_);
    ASSERT_EQ(render.exit_code, 0) << render.err;
    EXPECT_THAT(render.out, HasSubstr("120 avatars"));
  }
  const std::string png = read_file(folder_ / "a.png");
  EXPECT_THAT(png, StartsWith("\x89PNG"));
  EXPECT_GT(png.size(), 5000u) << "an empty picture compresses to less";
  EXPECT_TRUE(png == read_file(folder_ / "b.png"));
}

TEST_F(Log, IsDrawnFromAnotherPoint) {
  const std::string line = "throng render run.lcmlog --frame 20 --width 320 --height 200 --out ";
  ASSERT_EQ(shell(line + "a.png", folder_).exit_code, 0);
  const Outcome near = shell(line + "b.png --eye 0,-6,3 --target 0,0,1", folder_);
  ASSERT_EQ(near.exit_code, 0) << near.err;
  EXPECT_FALSE(read_file(folder_ / "a.png") == read_file(folder_ / "b.png"));
}

TEST_F(Log, RejectsFramesBeyondTheEnd) {
  const Outcome render = shell("throng render run.lcmlog --frame 99 --out a.png", folder_);
  EXPECT_EQ(render.exit_code, 2);
  EXPECT_THAT(render.err, HasSubstr("expected frame 99, found frames 0 to 29"));
}

TEST_F(Log, ReportsAPictureThatCannotBeWritten) {
  const Outcome render =
      shell("throng render run.lcmlog --frame 1 --out run.lcmlog/a.png", folder_);
  EXPECT_EQ(render.exit_code, 3);
  EXPECT_EQ(line_count(render.err), 1) << render.err;
}

}  // namespace
}  // namespace throng::log_test
