// `throng run --trajectory` and `--contacts` from outside: files that other programs open, and
// disks that are full.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(TrajectoryFiles, AreWrittenSideBySide) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "throng run corridor --avatars 20 --seconds 1 --lcm off --log off --trajectory t.csv "
      "--trajectory t.sqlite --trajectory-fps 20",
      folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  // One header; 60 steps at 60 Hz are 20 recorded frames of 20 people.
  EXPECT_EQ(line_count(read_file(folder / "t.csv")), 1 + 20 * 20);
  EXPECT_THAT(read_file(folder / "t.sqlite"), StartsWith("SQLite format 3"));
}

TEST(TrajectoryFiles, ChangeNoEvent) {
  const ScratchFolder folder;
  const std::string run = "throng run corridor --seconds 1 --lcm off --log off";
  const auto hash = [&](const std::string& options) {
    const Outcome outcome = shell(run + options + " | grep hash", folder);
    EXPECT_THAT(outcome.out, StartsWith("hash"));
    return outcome.out;
  };
  EXPECT_EQ(hash(""), hash(" --trajectory t.sqlite"));
}

TEST(TrajectoryFiles, OtherNamesAreBadInput) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng run corridor --trajectory t.txt", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr(".sqlite or .csv, found 't.txt'"));
}

TEST(ContactFiles, SayTheSameAsTheRun) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "throng run corridor --seconds 10 --lcm off --log off --contacts c --json r.json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto contacts = nlohmann::json::parse(read_file(folder / "r.json"))["contacts"];
  EXPECT_GT(contacts["people"], 0);
  EXPECT_EQ(line_count(read_file(folder / "c/contacts.csv")), 1 + contacts["people"].get<int>());
  EXPECT_EQ(line_count(read_file(folder / "c/people.csv")), 1 + 120);
  EXPECT_EQ(line_count(read_file(folder / "c/parts.csv")), 1 + 15);
  EXPECT_EQ(line_count(read_file(folder / "c/density.csv")), 1 + 6);
  // Every pair of parts that began to touch has a row of its own.
  const Outcome parts = shell("awk -F, 'NR>1 {n+=$10} END {print n}' c/contacts.csv", folder);
  EXPECT_EQ(line_count(read_file(folder / "c/pairs.csv")), 1 + std::stoi(parts.out));
  EXPECT_EQ(shell("tail -n +2 c/pairs.csv | LC_ALL=C sort -s -c -t, -k1,1n -k3,3n -k5,5n", folder)
                .exit_code,
            0);
  for (const char* figure :
       {"contact_rates", "contact_durations", "contact_parts", "contact_density"})
    EXPECT_THAT(read_file(folder / ("c/" + std::string(figure) + ".svg")), HasSubstr("</svg>"));
}

TEST(ContactFiles, OfASceneWithNobodyInItHaveNoRows) {
  const ScratchFolder folder;
  write_file(folder / "later.yaml", R"(
name: later
duration_s: 1
ground: {min_m: [-10, -10], max_m: [10, 10]}
groups:
  - name: them
    count: 0
    sources: [{area: {min_m: [-5, -5], max_m: [-2, -2]}, count: 5, rate_per_s: 1, start_s: 50}]
    goals: [{min_m: [2, 2], max_m: [5, 5]}]
)");
  const Outcome outcome = shell("throng run later.yaml --lcm off --log off --contacts c", folder);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("note: no "));
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("gnuplot>")));
  EXPECT_EQ(line_count(read_file(folder / "c/pairs.csv")), 1);
  EXPECT_EQ(line_count(read_file(folder / "c/contacts.csv")), 1);
  EXPECT_EQ(line_count(read_file(folder / "c/people.csv")), 1 + 5);
}

TEST(ContactFiles, AFolderThatCannotBeIsTold) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("echo >f; throng run corridor --lcm off --log off --contacts f/c", folder);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("f/c"));
}

/// A limit on file sizes stands in for a full disk.
class FullDisk : public testing::TestWithParam<const char*> {};

TEST_P(FullDisk, EndsTheRunAndLeavesWhatWasWritten) {
  const ScratchFolder folder;
  const std::string file = GetParam();
  const Outcome outcome = shell(
      "trap '' XFSZ; ulimit -f 6000; throng run corridor --seconds 60 "
      "--lcm off --log off --trajectory-fps 60 --trajectory " +
          file,
      folder);
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(file + ": cannot write the trajectory"));
  EXPECT_THAT(outcome.out, HasSubstr("ordop26")) << "the table of what was computed is lost";
  EXPECT_GT(std::filesystem::file_size(folder / file), 1'000'000u);
}

INSTANTIATE_TEST_SUITE_P(Trajectory, FullDisk, testing::Values("t.sqlite", "t.csv"),
                         [](const auto& each) { return std::string(each.param).substr(2); });

TEST(TrajectoryFiles, OfAFullDiskEndWithAWholeFrame) {
  const ScratchFolder folder;
  shell(
      "trap '' XFSZ; ulimit -f 200; throng run corridor --seconds 60 --lcm off --log off "
      "--trajectory-fps 60 --trajectory t.csv",
      folder);
  const std::string text = read_file(folder / "t.csv");
  ASSERT_FALSE(text.empty());
  EXPECT_EQ(text.back(), '\n');
  EXPECT_EQ((line_count(text) - 1) % 120, 0) << "corridor has 120 people";
}

}  // namespace
}  // namespace throng
