// Standard streams that are closed, full or abandoned by their reader. Messages may be lost, files
// may not, and results that cannot be written are an error.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/apps/cli.h"
#include "tests/apps/workplace.h"

namespace throng::streams_test {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kRun = "throng run plaza --avatars 50 --seconds 0.5 --lcm off --log run.lcmlog ";

class UnwritableStderr : public testing::TestWithParam<const char*> {};

TEST_P(UnwritableStderr, LosesOnlyMessages) {
  const ScratchFolder folder;
  const Outcome plain = shell(kRun + GetParam(), folder);
  EXPECT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_THAT(plain.out, HasSubstr("hash"));
  const Outcome check = shell("throng check run.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out;
  const Outcome rejected = shell(std::string("throng run nowhere ") + GetParam(), folder);
  EXPECT_EQ(rejected.exit_code, 2) << rejected.err;
}

INSTANTIATE_TEST_SUITE_P(Stderr, UnwritableStderr, testing::Values("2>/dev/full", "2>&-"));

TEST(Streams, AllowAReaderOfMessagesToLeave) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "{ { throng run plaza --avatars 30000 --seconds 0.02 --lcm off --log run.lcmlog "
      "2>&1 1>&3 3>&- | true; echo $? >&2; } 3>&1; }",
      folder);
  EXPECT_EQ(shell("throng check run.lcmlog", folder).exit_code, 0) << outcome.err;
}

/// Every command that prints results, in a Workplace.
const std::vector<std::string> kPrinting = {
    "throng --version",
    "throng --help",
    "throng help run",
    "throng run --help",
    "throng scenes",
    "throng scenes --schema",
    "throng info body.tri",
    "throng info body.urdf",
    "throng info my.yaml",
    "throng info a.lcmlog",
    "throng info walk.csv --columns id=id,t=t,x=x,y=y",
    "throng check a.lcmlog",
    "throng monitor a.lcmlog",
    "throng monitor a.lcmlog --json",
    "throng monitor --lcm memq:// --seconds 3",
    "throng export a.lcmlog --csv states",
    "throng export a.lcmlog --mcap a.mcap",
    "throng run corridor --avatars 4 --seconds 0.1 --lcm off --log off",
    "throng run corridor --avatars 4 --seconds 0.1 --lcm off --log off --json -",
    "throng validate --only rimea_1",
    "throng validate --only rimea_1 --json -",
    "throng compare a.lcmlog a.lcmlog",
    "throng bench --avatars 50 --engines none --frames 2",
    "throng bench --avatars 50 --engines none --frames 2 --json -",
    "throng bench --avatars 50 --frames 1 --false-positives ordop26",
    "throng render a.lcmlog --frame 1 --width 64 --height 64 --out a.png",
    "throng view a.lcmlog --html a.html"};

TEST(Streams, AllowAReaderOfResultsToLeave) {
  Workplace place;
  write_file(place / "walk.csv", "id,t,x,y\n1,0,0,0\n1,0.1,0.1,0\n1,0.2,0.2,0\n1,0.3,0.3,0\n");
  for (const std::string& command : kPrinting) {
    SCOPED_TRACE(command);
    // A pipe without a reader: the first write fails.
    const Outcome left = shell(
        "rm -f pipe; mkfifo pipe; exec 3<>pipe 4>pipe 3>&-; " + command + " >&4", place.folder());
    EXPECT_EQ(left.exit_code, 0) << left.err;
    EXPECT_THAT(left.err, Not(HasSubstr("standard output")));
    EXPECT_THAT(left.err, Not(HasSubstr("expected")));
    const Outcome full = shell(command + " >/dev/full", place.folder());
    EXPECT_EQ(full.exit_code, 3) << full.err;
    EXPECT_THAT(full.err, HasSubstr("throng: could not write to the standard output"));
  }
}

TEST(Streams, KeepFilesCompleteWhenTheReaderLeaves) {
  const ScratchFolder folder;
  const Outcome left =
      shell("mkfifo pipe; exec 3<>pipe 4>pipe 3>&-; " + kRun + "--json run.json >&4", folder);
  EXPECT_EQ(left.exit_code, 0) << left.err;
  EXPECT_THAT(read_file(folder / "run.json"), HasSubstr("\"hash\""));
  EXPECT_EQ(shell("throng check run.lcmlog", folder).exit_code, 0);
  // The exit code still reports the result of a check.
  const Outcome torn = shell(
      "exec 3<>pipe 4>pipe 3>&-; head -c 3000 run.lcmlog >torn.lcmlog; throng check torn.lcmlog "
      ">&4",
      folder);
  EXPECT_EQ(torn.exit_code, 1) << torn.err;
}

TEST(Streams, ReportResultsThatCannotBeWritten) {
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

TEST(Streams, LeaveTheLogIntactIfClosedAtTheStart) {
  const ScratchFolder folder;
  shell(kRun + "<&- >&- 2>&- || true", folder);
  const Outcome check = shell("throng check run.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out;
  EXPECT_THAT(check.out, HasSubstr("run.lcmlog: sound\n"));
  EXPECT_THAT(check.out, Not(HasSubstr("problem")));
}

TEST(Streams, HoldNothingButJsonOnRequest) {
  const ScratchFolder folder;
  for (const std::string command :
       {"throng run plaza --avatars 20 --seconds 0.2 --lcm off --log off --json -",
        "throng validate --only rimea_1 --json -",
        "throng bench --avatars 50 --engines none --frames 2 --json -",
        "throng bench --avatars 50 --frames 1 --false-positives ordop26 --json -",
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
}  // namespace throng::streams_test
