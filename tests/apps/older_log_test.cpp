// Existing outputs: an older log of the same name, and a run that is writing it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/apps/workplace.h"

namespace throng::older_log_test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(OutputPlan, KeepsThePreviousDefaultLog) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --seed ";
  const Outcome first = shell(run + "1", place.folder());
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err, Not(HasSubstr("kept")));
  const std::string one = read_file(place / "out/my.lcmlog");
  const Outcome second = shell(run + "2", place.folder());
  EXPECT_THAT(second.err, testing::ContainsRegex("note: out/my.lcmlog of [-0-9]+ [:0-9]+, [.0-9]+ "
                                                 "[kM]B, is kept as out/my.previous.lcmlog\n"));
  EXPECT_EQ(line_count(second.err), line_count(first.err) + 1) << second.err;
  EXPECT_EQ(read_file(place / "out/my.previous.lcmlog"), one);
  const std::string two = read_file(place / "out/my.lcmlog");
  EXPECT_NE(two, one);
  EXPECT_THAT(shell(run + "3", place.folder()).err, HasSubstr("in place of the one of"));
  EXPECT_EQ(read_file(place / "out/my.previous.lcmlog"), two);
  expect_rejected(place, run + "4 --json out/my.previous.lcmlog", kTwice);
  expect_rejected(place, run + "4 --json out/my.lcmlog", kTwice);
}

TEST(OutputPlan, NotesAReplacedLog) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --log x.lcmlog";
  const Outcome first = shell(run, place.folder());
  EXPECT_THAT(first.err, Not(HasSubstr("replaced")));
  const Outcome second = shell(run, place.folder());
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_THAT(second.err, testing::ContainsRegex(
                              "note: x.lcmlog of [-0-9]+ [:0-9]+, [.0-9]+ [kM]B, is replaced\n"));
}

TEST(OutputPlan, RejectsAnOutputOfARunningProgram) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "out/my.lcmlog"},
      {"--log x.lcmlog", "x.lcmlog"},
      {"--log off --trajectory x.csv", "x.csv"},
      {"--log off --trajectory x.sqlite", "x.sqlite"},
      {"--log off --contacts c", "c"},
      {"--log off --trace-hash x", "x"}};
  for (const auto& [outputs, output] : cases) {
    SCOPED_TRACE(outputs);
    Workplace place;
    // The first run is paced: it writes for seconds after its output appears.
    const Outcome outcome = shell(
        fmt::format("throng run my.yaml --seconds 6 --pace 1 --lcm off {0} >first.txt 2>&1 &\n"
                    "first=$!\nuntil [ -e {1} ]; do sleep 0.05; done\nsleep 0.3\n"
                    "throng run my.yaml --seconds 6 --lcm off {0} && second=0 || second=$?\n"
                    "kill -0 $first || echo the first one has ended >&2\n"
                    "wait $first\nexit $second",
                    outputs, output),
        place.folder());
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("another run of throng is writing it; choose another name"));
    EXPECT_EQ(line_count(without_notes(outcome.err)), 1) << outcome.err;
    EXPECT_THAT(read_file(place / "first.txt"), HasSubstr("hash"));
    if (std::string(outputs).find("off") != std::string::npos) continue;
    const std::string log = std::string(outputs).empty() ? "out/my.lcmlog" : "x.lcmlog";
    EXPECT_THAT(shell("throng check " + log, place.folder()).out,
                testing::StartsWith(log + ": sound\n"));
    EXPECT_FALSE(std::filesystem::exists(place / "out/my.previous.lcmlog"));
  }
}

}  // namespace
}  // namespace throng::older_log_test
