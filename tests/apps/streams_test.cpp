// Standard streams that are closed, full or left by their reader: messages may be lost, work may
// not, and results that nobody could read are an error.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/apps/cli.h"

namespace throng {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kRun = "throng run plaza --avatars 50 --seconds 0.5 --lcm off --log run.lcmlog ";

class Deaf : public testing::TestWithParam<const char*> {};

TEST_P(Deaf, StandardErrorLosesMessagesOnly) {
  const ScratchFolder folder;
  const Outcome plain = shell(kRun + GetParam(), folder);
  EXPECT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_THAT(plain.out, HasSubstr("hash"));
  const Outcome check = shell("throng check run.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out;
  const Outcome refused = shell(std::string("throng run nowhere ") + GetParam(), folder);
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
}

INSTANTIATE_TEST_SUITE_P(Stderr, Deaf, testing::Values("2>/dev/full", "2>&-"));

TEST(Streams, AReaderOfMessagesMayLeave) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "{ { throng run plaza --avatars 30000 --seconds 0.02 --lcm off --log run.lcmlog "
      "2>&1 1>&3 3>&- | true; echo $? >&2; } 3>&1; }",
      folder);
  EXPECT_EQ(shell("throng check run.lcmlog", folder).exit_code, 0) << outcome.err;
}

TEST(Streams, ResultsThatNobodyGetsAreAnError) {
  const ScratchFolder folder;
  for (const char* where : {">&-", ">/dev/full"}) {
    const Outcome outcome = shell(kRun + "--json run.json " + where, folder);
    EXPECT_EQ(outcome.exit_code, 3) << where;
    EXPECT_THAT(outcome.err, HasSubstr("throng: could not write to the standard output")) << where;
    EXPECT_THAT(read_file(folder / "run.json"), HasSubstr("\"hash\"")) << where;
    EXPECT_EQ(shell("throng check run.lcmlog", folder).exit_code, 0) << where;
  }
  EXPECT_EQ(shell("throng scenes >&-", folder).exit_code, 3);
  EXPECT_EQ(shell("throng --version >&-", folder).exit_code, 3);
}

TEST(Streams, AllClosedAtTheStartLeaveTheLogAlone) {
  const ScratchFolder folder;
  shell(kRun + "<&- >&- 2>&- || true", folder);
  const Outcome check = shell("throng check run.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out;
  EXPECT_THAT(check.out, HasSubstr("run.lcmlog: sound\n"));
  EXPECT_THAT(check.out, Not(HasSubstr("problem")));
}

TEST(Streams, JsonOnStandardOutputStandsAlone) {
  const ScratchFolder folder;
  for (const std::string command :
       {"throng run plaza --avatars 20 --seconds 0.2 --lcm off --log off --json -",
        "throng validate --only rimea_1 --json -",
        "throng bench --avatars 50 --engines none --frames 2 --json -",
        "throng bench --avatars 50 --frames 1 --parts ordop26 --json -",
        "throng monitor --lcm memq:// --seconds 0.1 --json - || true"}) {
    const Outcome outcome = shell(command, folder);
    EXPECT_EQ(outcome.exit_code, 0) << command << outcome.err;
    EXPECT_THAT(outcome.out, testing::StartsWith("{")) << command;
    EXPECT_THAT(outcome.out, testing::EndsWith("}\n")) << command;
    EXPECT_THAT(outcome.out, HasSubstr("\"throng\": {\n    \"version\": \"")) << command;
    EXPECT_THAT(outcome.out, HasSubstr("\"commit\": \"")) << command;
    EXPECT_FALSE(std::filesystem::exists(folder / "-")) << command;
  }
}

}  // namespace
}  // namespace throng
