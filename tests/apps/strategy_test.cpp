// `throng run --strategy`: the paper's strategies on any scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"
#include "tests/apps/run_json.h"

namespace throng::strategy_test {
namespace {

using Json = nlohmann::json;

TEST(RunStrategy, GivesTheSameEventsWithTriangles) {
  const ScratchFolder folder;
  for (const std::string scene : {"paper_50 --seconds 0.5", "plaza --seconds 0.05 --avatars 40"}) {
    const std::string base = scene + " --exact --log off --strategy ";
    const Json expected = run_json(base + "pipeline", folder);
    for (const char* strategy : {"volume", "hybrid-all", "two-pass"}) {
      const Json found = run_json(base + strategy, folder);
      EXPECT_EQ(found["hash"], expected["hash"]) << scene << ", " << strategy;
      EXPECT_EQ(found["events"], expected["events"]) << scene << ", " << strategy;
      EXPECT_NE(found["run_id"], expected["run_id"]) << strategy;
    }
  }
}

TEST(RunStrategy, FindsTheSamePairsWithHybridAllAndTwoPass) {
  const ScratchFolder folder;
  const std::string base = "paper_350 --seconds 0.2 --log off --strategy ";
  const Json all = run_json(base + "hybrid-all", folder), two = run_json(base + "two-pass", folder);
  EXPECT_EQ(all["hash"], two["hash"]);
  EXPECT_GT(two["events"]["begin"], 0);
  EXPECT_EQ(all["stages"]["body_sphere"]["tests"], two["stages"]["body_sphere"]["tests"]);
  EXPECT_EQ(all["stages"]["part_volume"]["tests"], two["stages"]["part_volume"]["tests"]);
  EXPECT_GT(all["stages"]["part_volume"]["updates"], two["stages"]["part_volume"]["updates"]);
  EXPECT_EQ(run_json(base + "two-pass --pair-search grid", folder)["hash"], two["hash"]);
  EXPECT_EQ(run_json(base + "none", folder)["events"]["begin"], 0);
}

TEST(RunStrategy, ReportsWholeBodiesWithSpheres) {
  const ScratchFolder folder;
  run_json("paper_50 --seconds 0.2 --strategy sphere --log s.lcmlog", folder);
  const Outcome check = shell("throng check s.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out;
  EXPECT_THAT(check.out, ::testing::HasSubstr("levels     contacts by level: spheres "));
}

TEST(RunStrategy, NamesOmittedContactsInTheLog) {
  const ScratchFolder folder;
  const std::pair<const char*, const char*> cases[] = {
      {"none", "every contact: nothing was tested"},
      {"sphere", "body parts: a pair is two whole bodies whose spheres meet"},
      {"hybrid-one", "every contact but those of the first body"}};
  for (const auto& [strategy, words] : cases) {
    run_json(std::string("paper_15 --seconds 0.1 --log a.lcmlog --strategy ") + strategy, folder);
    const Outcome check = shell("throng check a.lcmlog", folder);
    EXPECT_EQ(check.exit_code, 0) << check.out;
    EXPECT_THAT(check.out, ::testing::HasSubstr(words));
    EXPECT_THAT(shell("throng info a.lcmlog", folder).out,
                ::testing::HasSubstr(std::string("omits ") + words));
  }
  run_json("paper_15 --seconds 0.1 --log a.lcmlog --strategy two-pass", folder);
  EXPECT_THAT(shell("throng check a.lcmlog", folder).out,
              ::testing::Not(::testing::HasSubstr("omits")));
}

TEST(RunStrategy, RejectsBudgetsAndOtherNames) {
  const ScratchFolder folder;
  for (const char* options : {"--strategy two-pass --budget-ms 5", "--strategy three-pass",
                              "--strategy sphere --exact"}) {
    const Outcome rejected =
        shell(std::string("throng run paper_15 --lcm off --log off ") + options, folder);
    EXPECT_EQ(rejected.exit_code, 2) << options;
    EXPECT_EQ(line_count(rejected.err), 1) << rejected.err;
  }
}

}  // namespace
}  // namespace throng::strategy_test
