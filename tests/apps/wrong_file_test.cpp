// Requests for help, and inputs of the wrong kind, are answered before any work.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/apps/cli.h"

namespace throng::wrong_file_test {
namespace {

using testing::HasSubstr;

TEST(Help, IsACommand) {
  const ScratchFolder folder;
  EXPECT_EQ(shell("throng help", folder).out, shell("throng --help", folder).out);
  for (const std::string command : {"run", "paper", "validate", "monitor"})
    EXPECT_EQ(shell("throng help " + command, folder).out,
              shell("throng " + command + " --help", folder).out);
  const Outcome wrong = shell("throng help rum", folder);
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("(did you mean 'run'?)"));
}

TEST(Help, PrintsVersionAndCommit) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng -V", folder);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out,
              testing::MatchesRegex("throng [0-9.]+ \\(([0-9a-f]+(-dirty)?|unknown)\\)\n"));
  EXPECT_EQ(outcome.out, shell("throng --version", folder).out);
}

TEST(WrongFile, IsReportedWithItsKind) {
  const ScratchFolder folder;
  ASSERT_EQ(shell("throng run plaza --avatars 5 --seconds 0.1 --lcm off --log a.lcmlog "
                  "--trajectory a.sqlite --trajectory a.csv --checkpoint a.checkpoint "
                  "--checkpoint-every 0.05 "
                  "--json a.json",
                  folder)
                .exit_code,
            0);
  const std::string adult = "avatars/models/adult/";
  const struct {
    std::string file, words;
  } cases[] = {
      {"a.checkpoint", "found a checkpoint; `throng run SCENE --resume FILE` continues from it"},
      {"a.json", "found results written by --json"},
      {repository(adult + "head.tri"), "found a .tri mesh; `throng info` reads it"},
      {repository(adult + "adult.urdf"), "found a URDF; `throng info` reads it"},
  };
  for (const auto& [file, words] : cases) {
    const Outcome outcome = shell("throng run " + file, folder);
    EXPECT_EQ(outcome.exit_code, 2) << file;
    EXPECT_THAT(outcome.err, HasSubstr(words));
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  }
  // Recognised by content under any name: a log is culled again.
  const Outcome renamed =
      shell("mv a.lcmlog a.yaml; throng run a.yaml --lcm off --log off", folder);
  EXPECT_EQ(renamed.exit_code, 0) << renamed.err;
}

TEST(WrongFile, IsRejectedByRenderBeforeTheWork) {
  const ScratchFolder folder;
  ASSERT_EQ(shell("throng run plaza --avatars 5 --seconds 0.2 --lcm off --log a.lcmlog", folder)
                .exit_code,
            0);
  const struct {
    const char *options, *words;
  } cases[] = {
      {"--frame 3 --out a.jpg", "--out: expected a name that ends in .png"},
      {"--frame 3 --out a", "--out: expected a name that ends in .png"},
      {"--frames 1:3 --out a.png",
       "--out: expected a folder for numbered PNGs, or a name that ends in .webp"},
      {"--frames 3:1 --out a.webp",
       "--frames: expected FIRST:LAST with FIRST up to LAST, found 3:1"},
      {"--frames 0:12 --out a.webp", "a.lcmlog: expected frame 12, found frames 0 to 11"},
      {"--frame 12 --out a.png", "a.lcmlog: expected frame 12, found frames 0 to 11"},
  };
  for (const auto& [options, words] : cases) {
    const Outcome outcome = shell(std::string("throng render a.lcmlog ") + options, folder);
    EXPECT_EQ(outcome.exit_code, 2) << options;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << options;
  }
  for (const char* name : {"a.jpg", "a", "a.png", "a.webp"})
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
}

TEST(Info, NamesTheControlChannelOfAGroup) {
  const ScratchFolder folder;
  write_file(folder / "robot.yaml",
             "ground: {min_m: [-5, -5], max_m: [5, 5]}\nduration_s: 1\ngroups:\n"
             "  - name: robot\n    count: 1\n    spawn: {min_m: [-1, -1], max_m: [1, 1]}\n"
             "    control_channel: ROBOT_DRIVE\n");
  const Outcome outcome = shell("throng info robot.yaml", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("control  by messages on the LCM channel ROBOT_DRIVE only"));
}

TEST(Info, FindsAPathAlongALongThinGround) {
  for (const double length_m : {1000.0, 5000.0, 20000.0, 99000.0}) {
    const ScratchFolder folder;
    const std::string length = std::to_string(length_m), near = std::to_string(length_m - 4);
    write_file(
        folder / "thin.yaml",
        fmt::format(
            "ground: {{min_m: [0, 0], max_m: [{0}, 0.5]}}\nduration_s: 1\ngroups:\n"
            "  - name: walkers\n    count: 2\n    spawn: {{min_m: [0, 0.1], max_m: [4, 0.4]}}\n"
            "    goals:\n      - {{min_m: [{1}, 0.1], max_m: [{0}, 0.4]}}\n",
            length, near));
    const Outcome outcome = shell("throng info thin.yaml", folder);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(
        outcome.out,
        HasSubstr("path     " + std::to_string(static_cast<int>(length_m) - 4) + ".0 m to goal 1"));
  }
}

TEST(Lcm, ReportsAMissingServerOnce) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "throng run plaza --avatars 20 --seconds 1 --lcm tcpq://127.0.0.1:9 --log off --json r.json",
      folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err,
              HasSubstr("LCM has no server at tcpq://127.0.0.1:9: nothing is published"));
  EXPECT_THAT(outcome.out,
              testing::ContainsRegex("tcpq://127.0.0.1:9: 0 messages, .*, [1-9][0-9]+ dropped"));
}

}  // namespace
}  // namespace throng::wrong_file_test
