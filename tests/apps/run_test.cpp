// `throng run`: the same events in every configuration, and complete JSON.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/apps/cli.h"
#include "tests/apps/run_json.h"

namespace throng::run_test {
namespace {

using Json = nlohmann::json;

TEST(Run, GivesTheSameEventsAndLogWithOneAndTwoThreads) {
  const ScratchFolder folder;
  const Json one = run_json("plaza --seconds 1 --threads 1 --log one.lcmlog", folder);
  const Json two = run_json("plaza --seconds 1 --threads 2 --log two.lcmlog", folder);
  EXPECT_EQ(one["hash"], two["hash"]);
  EXPECT_EQ(one["run_id"], two["run_id"]);
  EXPECT_EQ(one["events"], two["events"]);
  EXPECT_GT(one["events"]["begin"], 0);
  // Not compared by EXPECT_EQ: a difference would print megabytes.
  EXPECT_TRUE(read_file(folder / "one.lcmlog") == read_file(folder / "two.lcmlog"));
}

TEST(Run, FollowsTheClockWithPaceAndKeepsItsEvents) {
  const ScratchFolder folder;
  const Json free = run_json("corridor --seconds 0.5 --log free.lcmlog", folder);
  const Json paced = run_json("corridor --seconds 0.5 --log paced.lcmlog --pace 0.5", folder);
  EXPECT_FALSE(free.contains("pace"));
  EXPECT_EQ(paced["pace"]["factor"], 0.5);
  EXPECT_GE(paced["wall_s"], 1.0) << "half of real time takes twice as long";
  EXPECT_EQ(paced["hash"], free["hash"]);
  EXPECT_TRUE(read_file(folder / "free.lcmlog") == read_file(folder / "paced.lcmlog"));
}

TEST(Run, CountsLateFrames) {
  const ScratchFolder folder;
  const Json paced = run_json("plaza --seconds 2 --log off --pace 100000", folder);
  EXPECT_GT(paced["pace"]["late_frames"], 0);
  EXPECT_GT(paced["pace"]["behind_ms"], 0);
  EXPECT_GE(paced["pace"]["worst_ms"], paced["pace"]["behind_ms"]);
}

TEST(Run, GivesTheSameEventsForAnySimdAndPairSearch) {
  const ScratchFolder folder;
  const std::string base = "plaza --seconds 0.5 --log off";
  const Json best = run_json(base, folder);
  for (const char* option : {" --simd scalar", " --pair-search brute", " --pair-search sweep"}) {
    const Json other = run_json(base + option, folder);
    EXPECT_EQ(other["hash"], best["hash"]) << option;
    EXPECT_EQ(other["run_id"], best["run_id"]) << option;
  }
}

TEST(Run, ChangesWithSeedVolumeAndTriangles) {
  const ScratchFolder folder;
  const std::string base = "plaza --seconds 2 --avatars 200 --log off";
  const Json first = run_json(base, folder);
  for (const char* option : {" --seed 99", " --part-volume sphere", " --exact"}) {
    const Json other = run_json(base + option, folder);
    EXPECT_NE(other["run_id"], first["run_id"]) << option;
    EXPECT_NE(other["hash"], first["hash"]) << option;
  }
}

TEST(Run, ReportsNoMorePairsWithTighterVolumes) {
  const ScratchFolder folder;
  const std::string base = "plaza --seconds 0.2 --log off ";
  const Json sphere = run_json(base + "--part-volume sphere", folder);
  const Json ordop = run_json(base + "--part-volume ordop26", folder);
  const Json exact = run_json(base + "--part-volume ordop26 --exact", folder);
  EXPECT_LT(ordop["pairs_peak"], sphere["pairs_peak"]);
  EXPECT_LE(exact["pairs_peak"], ordop["pairs_peak"]);
  EXPECT_EQ(ordop["stages"]["part_volume"]["volume"], "ordop26");
  EXPECT_EQ(ordop["stages"]["triangles"]["tests"], 0);
  EXPECT_GT(exact["stages"]["triangles"]["tests"], 0);
}

TEST(Run, WritesEveryDocumentedJsonKey) {
  const ScratchFolder folder;
  const Json json = run_json("plaza --seconds 0.5 --threads 1 --seed 3 --log run.lcmlog", folder);
  for (const char* key : {"/scene",
                          "/seed",
                          "/avatars",
                          "/parts",
                          "/frames",
                          "/step_s",
                          "/threads",
                          "/wall_s",
                          "/realtime_factor",
                          "/frame_ms/median",
                          "/frame_ms/p95",
                          "/frame_ms/max",
                          "/cull_ms/median",
                          "/stage_ms/steering",
                          "/stage_ms/gait",
                          "/stage_ms/kinematics",
                          "/stage_ms/broad_phase",
                          "/stage_ms/mid_phase",
                          "/stage_ms/narrow_phase",
                          "/stage_ms/events",
                          "/stage_ms/publish",
                          "/events/begin",
                          "/events/persist",
                          "/events/end",
                          "/pairs_peak",
                          "/hash",
                          "/lcm/url",
                          "/lcm/messages",
                          "/lcm/bytes",
                          "/lcm/dropped",
                          "/peak_rss_bytes",
                          "/machine/cpu",
                          "/machine/simd"})
    EXPECT_TRUE(json.contains(Json::json_pointer(key))) << key;
  for (const char* stage : {"body_sphere", "part_volume", "triangles"})
    for (const char* key : {"volume", "updates", "tests", "passed", "update_ns", "test_ns"})
      EXPECT_TRUE(json["stages"][stage].contains(key)) << stage << " " << key;
}

TEST(Run, WritesConsistentFigures) {
  const ScratchFolder folder;
  const Json json = run_json("plaza --seconds 0.5 --threads 1 --seed 3 --log run.lcmlog", folder);
  EXPECT_EQ(json["scene"], "plaza");
  EXPECT_EQ(json["seed"], 3);
  EXPECT_EQ(json["avatars"], 500);
  EXPECT_EQ(json["parts"], 7500);
  EXPECT_EQ(json["frames"], 30);
  EXPECT_NEAR(json["step_s"].get<double>(), 1.0 / 60, 1e-9);
  EXPECT_EQ(json["threads"], 1);
  EXPECT_TRUE(json["hash"].is_string());
  EXPECT_EQ(json["lcm"]["url"], "off");
  EXPECT_EQ(json["events"]["begin"], json["events"]["end"]);
  EXPECT_EQ(json["log"]["bytes"].get<size_t>(), read_file(folder / "run.lcmlog").size());
  EXPECT_NEAR(json["realtime_factor"].get<double>(), 0.5 / json["wall_s"].get<double>(),
              0.01 * json["realtime_factor"].get<double>());
  EXPECT_LE(json["frame_ms"]["median"], json["frame_ms"]["p95"]);
  EXPECT_LE(json["frame_ms"]["p95"], json["frame_ms"]["max"]);
  for (const char* stage : {"body_sphere", "part_volume", "triangles"})
    EXPECT_LE(json["stages"][stage]["passed"], json["stages"][stage]["tests"]) << stage;
  EXPECT_GT(json["peak_rss_bytes"], 1'000'000);
}

TEST(Run, TakesTheRequestedNumberOfPeople) {
  const ScratchFolder folder;
  for (const int people : {1, 7, 1000})
    EXPECT_EQ(run_json("plaza --seconds 0.05 --log off --avatars " + std::to_string(people),
                       folder)["avatars"],
              people);
}

TEST(Run, PrintsOnlyResultsWithoutATerminal) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng run plaza --seconds 0.1 --lcm off", folder);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  for (const char* word : {"avatar", "sphere", "ordop26", "ns/test", "hash", "out/plaza.lcmlog"})
    EXPECT_THAT(outcome.out, testing::HasSubstr(word));
}

TEST(Run, WritesASoundLogWithAllEvents) {
  const ScratchFolder folder;
  const Json json = run_json("corridor --seconds 1 --log run.lcmlog", folder);
  const Outcome check = shell("throng check run.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  EXPECT_THAT(check.out, testing::HasSubstr(std::to_string(json["events"]["begin"].get<int>())));
}

TEST(Run, PublishesToLcmInMemory) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng run corridor --seconds 0.5 --log off --lcm memq:// --json r.json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = Json::parse(read_file(folder / "r.json"));
  EXPECT_EQ(json["lcm"]["url"], "memq://");
  EXPECT_GT(json["lcm"]["messages"], 30);
  EXPECT_EQ(json["lcm"]["dropped"], 0);
}

}  // namespace
}  // namespace throng::run_test
