// Logs with fewer states than frames, and with part poses, work with every reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng::states_test {
namespace {

using testing::HasSubstr;

/// A folder with the log of 61 frames at 60 frames per second, with states ten times per second.
class ThinLog : public testing::Test {
 protected:
  void SetUp() override { record("--states-hz 10 --log thin.lcmlog"); }
  void record(const std::string& options) {
    const Outcome run =
        shell("throng run plaza --avatars 60 --seconds 1.0167 --lcm off " + options, folder_);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  std::string info(const std::string& log) {
    const Outcome outcome = shell("throng info " + log, folder_);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  }
  /// Number of messages on a channel according to `throng info`; 0 if it has none.
  int messages(const std::string& log, const std::string& channel) {
    const std::string text = info(log);
    const size_t at = text.find("\n" + channel);
    return at == std::string::npos ? 0 : std::stoi(text.substr(at + 1 + channel.size()));
  }
  ScratchFolder folder_;
};

TEST_F(ThinLog, HasFewerStatesAndEveryContact) {
  record("--log full.lcmlog");
  EXPECT_EQ(messages("full.lcmlog", "THRONG_STATES"), 61);
  EXPECT_EQ(messages("thin.lcmlog", "THRONG_STATES"), 11);
  for (const char* channel : {"THRONG_FRAME_STATS", "THRONG_EVENTS", "THRONG_TOUCHING"})
    EXPECT_EQ(messages("thin.lcmlog", channel), messages("full.lcmlog", channel)) << channel;
}

TEST_F(ThinLog, IsSoundAndMonitored) {
  const Outcome check = shell("throng check thin.lcmlog", folder_);
  EXPECT_EQ(check.exit_code, 0) << check.out;
  const Outcome monitor = shell("throng monitor thin.lcmlog --json", folder_);
  ASSERT_EQ(monitor.exit_code, 0) << monitor.err;
  const auto json = nlohmann::json::parse(monitor.out);
  EXPECT_EQ(json["frames"], 61);
  EXPECT_EQ(json["lost"], 0);
}

TEST_F(ThinLog, DrawsPreviousStatesWithANote) {
  const std::string line = "throng render thin.lcmlog --width 160 --height 90 --out ";
  const Outcome with = shell(line + "a.png --frame 6", folder_);
  EXPECT_EQ(with.exit_code, 0);
  EXPECT_EQ(with.err, "");
  const Outcome without = shell(line + "b.png --frame 9", folder_);
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_EQ(without.err,
            "note: frame 9 has no states; the picture shows those of frame 6; the next states are "
            "of frame 12\n");
  const Outcome moving = shell(line + "c.webp --frames 0:24 --every 4", folder_);
  EXPECT_EQ(moving.exit_code, 0) << moving.err;
  EXPECT_THAT(moving.err, HasSubstr("3 of 7 frames have states"));
}

TEST_F(ThinLog, BecomesAPage) {
  const Outcome view = shell("throng view thin.lcmlog --html thin.html", folder_);
  ASSERT_EQ(view.exit_code, 0) << view.err;
  EXPECT_THAT(view.out, HasSubstr("60 people, 1.0 s"));
  EXPECT_THAT(read_file(folder_ / "thin.html"), HasSubstr("id=\"recording\""));
}

TEST_F(ThinLog, HasPartPosesWithStatesOnRequest) {
  record("--states-hz 10 --publish-part-poses --log parts.lcmlog");
  EXPECT_EQ(messages("thin.lcmlog", "THRONG_PART_POSES"), 0);
  EXPECT_EQ(messages("parts.lcmlog", "THRONG_PART_POSES"),
            messages("thin.lcmlog", "THRONG_STATES"));
  for (const char* line :
       {"throng check parts.lcmlog", "throng monitor parts.lcmlog --json",
        "throng view parts.lcmlog --html parts.html", "throng render parts.lcmlog --out parts.png"})
    EXPECT_EQ(shell(line, folder_).exit_code, 0) << line;
}

TEST_F(ThinLog, BeginsWithStatesWhenResumed) {
  record("--log off --checkpoint run.checkpoint --checkpoint-every 0.5");
  record("--states-hz 1 --log whole.lcmlog");
  record("--states-hz 1 --log rest.lcmlog --resume run.checkpoint");
  EXPECT_EQ(messages("whole.lcmlog", "THRONG_STATES"), 2) << "frames 0 and 60";
  const int frames = messages("rest.lcmlog", "THRONG_FRAME_STATS");
  ASSERT_THAT(frames, testing::AllOf(testing::Gt(0), testing::Lt(61)));
  const std::string first = std::to_string(61 - frames);
  const Outcome render = shell(
      "throng render rest.lcmlog --width 160 --height 90 --out a.png --frame " + first, folder_);
  EXPECT_EQ(render.exit_code, 0);
  EXPECT_EQ(render.err, "");
}

TEST_F(ThinLog, RejectsMoreStatesThanFrames) {
  const Outcome run =
      shell("throng run plaza --seconds 1 --lcm off --states-hz 61 --log no.lcmlog", folder_);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err,
            "--states-hz: expected at most 60, the frames per second of plaza, found 61\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "no.lcmlog"));
  EXPECT_EQ(shell("throng run plaza --seconds 0.0167 --lcm off --log off --states-hz 60", folder_)
                .exit_code,
            0);
  EXPECT_EQ(shell("throng run plaza --states-hz 0", folder_).exit_code, 2);
}

}  // namespace
}  // namespace throng::states_test
