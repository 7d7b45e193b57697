// `throng run` on recordings, found by content, by options, or by name.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng::run_recording_test {
namespace {

using testing::HasSubstr;

/// Two people that pass each other, in a table with custom column names.
std::string table(const std::string& header) {
  std::string text = header + "\n";
  for (int i = 0; i < 50; ++i) {
    text += fmt::format("3;{:.2f};{:.3f};0.25\n", 0.1 * i, 0.12 * i);
    text += fmt::format("8;{:.2f};{:.3f};0\n", 0.1 * i, 6 - 0.12 * i);
  }
  return text;
}

TEST(RunRecording, NeedsTheColumnNamesOfACustomTable) {
  const ScratchFolder folder;
  write_file(folder / "walk.csv", table("who;when;east;north"));
  const Outcome rejected = shell("throng run walk.csv --lcm off --log off", folder);
  EXPECT_EQ(rejected.exit_code, 2);
  EXPECT_THAT(rejected.err, HasSubstr("--columns"));
  const Outcome outcome = shell(
      "throng run walk.csv --columns id=who,t=when,x=east,y=north --lcm off --log walk.lcmlog "
      "--trajectory walk.sqlite --exact --json -",
      folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["recording"]["kind"], "table");
  EXPECT_EQ(json["recording"]["people"], 2);
  EXPECT_EQ(json["recording"]["frames"], 50);
  EXPECT_EQ(json["recording"]["fps"], 10.0);
  EXPECT_EQ(json["frames"], 49 * 6 + 1) << "six steps from one to the next, up to the last";
  EXPECT_GT(json["events"]["begin"], 0) << "the two must touch";
  EXPECT_EQ(shell("throng check walk.lcmlog", folder).exit_code, 0);
  // The trajectory is a recording again, and so is the log.
  for (const char* again : {"walk.sqlite", "walk.lcmlog"})
    EXPECT_EQ(shell(fmt::format("throng run {} --lcm off --log off", again), folder).exit_code, 0);
}

TEST(RunRecording, RejectsItsOptionsForOtherInput) {
  const ScratchFolder folder;
  const Outcome scene = shell("throng run plaza --fps 25 --lcm off --log off", folder);
  EXPECT_EQ(scene.exit_code, 2);
  EXPECT_THAT(scene.err, HasSubstr("--fps: expected a recording"));
  write_file(folder / "walk.csv", table("id;t;x;y"));
  const Outcome scaled = shell("throng run walk.csv --avatars 5 --lcm off --log off", folder);
  EXPECT_EQ(scaled.exit_code, 2);
  EXPECT_THAT(scaled.err, HasSubstr("--avatars: expected a scene"));
}

TEST(RunRecording, IsNamedByAScene) {
  const ScratchFolder folder;
  write_file(folder / "walk.csv", table("id;t;x;y"));
  write_file(
      folder / "walk.yaml",
      "kind: recorded\nrecording: {file: walk.csv, name: walkers, sampling: recorded, start_s: 1}\n"
      "obstacles:\n  - {kind: cylinder, position_m: [3, 3], diameter_m: 0.4, height_m: 2}\n"
      "ground: {min_m: [-5, -5], max_m: [10, 5]}\n");
  const Outcome outcome = shell("throng run walk.yaml --lcm off --log off --json -", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["frames"], 40);
  EXPECT_EQ(json["step_s"], 0.1);
  EXPECT_THAT(shell("throng info walk.yaml", folder).out, HasSubstr("walkers: 2 of 'adult'"));
  write_file(folder / "turned.csv", "id;t;x;y;heading\n1;0;0;0;90\n1;1;0.5;0;90\n");
  write_file(folder / "turned.yaml", "kind: recorded\nrecording: {file: turned.csv}\n");
  EXPECT_THAT(shell("throng run turned.yaml --lcm off --log off", folder).err,
              HasSubstr("turned.csv:2: expected headings from -2 pi to 2 pi rad"));
  write_file(folder / "turned.yaml",
             "kind: recorded\nrecording: {file: turned.csv, heading_unit: deg}\n");
  EXPECT_EQ(shell("throng run turned.yaml --lcm off --log off", folder).exit_code, 0);
  write_file(folder / "gone.yaml", "kind: recorded\nrecording: {file: $NOT_SET_AT_ALL/walk.csv}\n");
  const Outcome gone = shell("throng run gone.yaml", folder);
  EXPECT_EQ(gone.exit_code, 2);
  EXPECT_THAT(gone.err, HasSubstr("gone.yaml:2: expected NOT_SET_AT_ALL in the environment"));
}

}  // namespace
}  // namespace throng::run_recording_test
