// `throng run` with a budget: a budget of tests is reproducible, and every pair is reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng::budget_test {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

Outcome run(const std::string& options, const ScratchFolder& folder) {
  Outcome outcome = shell("throng run " + options + " --lcm off --json run.json", folder);
  EXPECT_EQ(outcome.exit_code, 0) << options << ": " << outcome.err;
  return outcome;
}

Json result(const ScratchFolder& folder) { return Json::parse(read_file(folder / "run.json")); }

TEST(RunWithBudget, GivesTheSameResultForAnyThreadsAndSimd) {
  const ScratchFolder folder;
  const std::string base = "plaza --seconds 0.5 --budget-tests 4000 --log ";
  run(base + "one.lcmlog --threads 1", folder);
  const Json one = result(folder);
  EXPECT_GT(one["budget"]["frames_cut"], 0);
  EXPECT_GT(one["budget"]["pairs"]["sphere"], 0);
  EXPECT_GT(one["budget"]["pairs"]["part_volume"], 0);
  EXPECT_EQ(one["budget"]["tests"], 4000);
  EXPECT_EQ(one["events"]["begin"], one["events"]["end"]);
  for (const char* option : {"--threads 2", "--simd scalar", "--pair-search brute"}) {
    run(base + "off " + option, folder);
    const Json other = result(folder);
    EXPECT_EQ(other["hash"], one["hash"]) << option;
    EXPECT_EQ(other["run_id"], one["run_id"]) << option;
    EXPECT_EQ(other["budget"], one["budget"]) << option;
  }
  run(base + "two.lcmlog --threads 2", folder);
  EXPECT_TRUE(read_file(folder / "one.lcmlog") == read_file(folder / "two.lcmlog"));
}

TEST(RunWithBudget, WritesASoundLogWithLevels) {
  const ScratchFolder folder;
  const Outcome cut =
      run("plaza --seconds 0.5 --exact --budget-tests 4000 --log cut.lcmlog", folder);
  EXPECT_THAT(cut.out, HasSubstr("budget    at most 4000 tests per frame: "));
  EXPECT_THAT(cut.out, HasSubstr("frames cut; pairs reported by spheres "));
  const Outcome check = shell("throng check cut.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out;
  EXPECT_THAT(check.out, HasSubstr("levels     contacts by level: spheres "));
  run("plaza --seconds 0.1 --log whole.lcmlog", folder);
  EXPECT_THAT(shell("throng check whole.lcmlog", folder).out, Not(HasSubstr("levels")));
}

TEST(RunWithBudget, PairsEventsWithABudgetInMilliseconds) {
  const ScratchFolder folder;
  run("plaza --seconds 0.5 --budget-ms 0 --log clock.lcmlog", folder);
  const Json json = result(folder);
  EXPECT_EQ(json["budget"]["ms"], 0);
  EXPECT_EQ(json["budget"]["frames_cut"], json["frames"]);
  EXPECT_EQ(json["events"]["begin"], json["events"]["end"]);
  EXPECT_GT(json["events"]["begin"], 0);
  EXPECT_EQ(shell("throng check clock.lcmlog", folder).exit_code, 0);
}

TEST(RunWithBudget, GivesTheSamePairsIfAmple) {
  const ScratchFolder folder;
  run("plaza --seconds 0.3 --log off", folder);
  const Json plain = result(folder);
  EXPECT_FALSE(plain.contains("budget"));
  run("plaza --seconds 0.3 --budget-tests 1000000000 --log off", folder);
  const Json ample = result(folder);
  EXPECT_EQ(ample["budget"]["frames_cut"], 0);
  EXPECT_EQ(ample["events"], plain["events"]);
  EXPECT_NE(ample["run_id"], plain["run_id"]);
}

TEST(RunWithBudget, RejectsInvalidBudgets) {
  const ScratchFolder folder;
  EXPECT_EQ(shell("throng run plaza --budget-ms -1 --lcm off --log off", folder).exit_code, 2);
  EXPECT_EQ(shell("throng run plaza --budget-tests many --lcm off --log off", folder).exit_code, 2);
}

}  // namespace
}  // namespace throng::budget_test
