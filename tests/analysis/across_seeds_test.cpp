// across_seeds() combines the outcomes of several seeds without hiding a bad one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "analysis/validation/validation.h"

namespace throng::validation::across_seeds_test {
namespace {

/// A reading with bounds 1.0 and 1.2.
Reading flow(double simulated, bool headline = true) {
  return {"door",  "flow", "1/s", simulated, 1.1, 1.0, 1.2, simulated >= 1.0 && simulated <= 1.2,
          headline};
}

SeedOutcome seed_with(uint64_t seed, double simulated) {
  SeedOutcome out{seed, {}, 1};
  out.outcome.readings = {flow(simulated)};
  out.outcome.passed = *out.outcome.readings[0].met;
  out.outcome.measured = "flow of seed " + std::to_string(seed);
  return out;
}

TEST(AcrossSeeds, KeepsTheOutcomeOfASingleSeed) {
  const std::vector<SeedOutcome> seeds = {seed_with(7, 1.1)};
  const Outcome outcome = across_seeds(seeds);
  EXPECT_EQ(outcome.verdict(), Verdict::kPass);
  EXPECT_EQ(outcome.measured, "flow of seed 7");
  EXPECT_TRUE(std::isnan(outcome.readings[0].worst));
}

TEST(AcrossSeeds, FailsIfOneSeedFails) {
  const std::vector<SeedOutcome> seeds = {seed_with(1, 1.1), seed_with(2, 1.3), seed_with(3, 1.05)};
  const Outcome outcome = across_seeds(seeds);
  EXPECT_EQ(outcome.verdict(), Verdict::kFail);
  EXPECT_EQ(outcome.readings[0].met, false);
  EXPECT_THAT(outcome.measured, testing::HasSubstr("2 of 3 seeds pass; worst, seed 2: flow"));
}

TEST(AcrossSeeds, ReportsTheMeanAndTheWorstReading) {
  const std::vector<SeedOutcome> seeds = {seed_with(1, 1.02), seed_with(2, 1.1),
                                          seed_with(3, 1.15)};
  const Outcome outcome = across_seeds(seeds);
  EXPECT_EQ(outcome.verdict(), Verdict::kPass);
  EXPECT_NEAR(outcome.readings[0].simulated, 1.09, 1e-12);
  EXPECT_EQ(outcome.readings[0].worst, 1.02) << "0.02 from the bound, others 0.05";
}

TEST(AcrossSeeds, NamesThePlaceOfMeansWithEqualNames) {
  std::vector<SeedOutcome> seeds = {seed_with(1, 1.02), seed_with(2, 1.1)};
  EXPECT_THAT(across_seeds(seeds).measured, testing::HasSubstr("; means: flow 1.06 1/s"));
  for (SeedOutcome& each : seeds) {
    each.outcome.readings.push_back(flow(1.2));
    each.outcome.readings.back().at = "gate";
  }
  EXPECT_THAT(across_seeds(seeds).measured,
              testing::HasSubstr("; means: flow (door) 1.06 1/s, flow (gate) 1.2 1/s"));
}

TEST(AcrossSeeds, AveragesOnlySeedsWithTheReading) {
  std::vector<SeedOutcome> seeds = {seed_with(1, 1.1), seed_with(2, 1.1)};
  seeds[0].outcome.readings[0].simulated = Reading::kNone;
  seeds[0].outcome.readings[0].met.reset();
  const Outcome outcome = across_seeds(seeds);
  EXPECT_EQ(outcome.readings[0].simulated, 1.1);
  EXPECT_EQ(outcome.readings[0].met, true);
}

TEST(AcrossSeeds, ReportsWallCrossingsAndUnplacedPeopleOfAnySeed) {
  std::vector<SeedOutcome> seeds = {seed_with(1, 1.1), seed_with(2, 1.1)};
  seeds[1].outcome.wall_crossings = 3;
  seeds[1].outcome.unplaced = 2;
  EXPECT_EQ(across_seeds(seeds).wall_crossings, 3);
  EXPECT_EQ(across_seeds(seeds).unplaced, 2);
}

TEST(Verdict, IsFailIfATestFailsAndDiffers) {
  Outcome outcome;
  outcome.differs = true;
  EXPECT_EQ(outcome.verdict(), Verdict::kFail);
  outcome.passed = true;
  EXPECT_EQ(outcome.verdict(), Verdict::kDiffers);
  const validation::Test full{{"full"}, {"full"}, "", "", [&](const Conditions&) {
                                Outcome unplaced = outcome;
                                unplaced.unplaced = 1;
                                return unplaced;
                              }};
  EXPECT_EQ(run_test(full, {}).verdict(), Verdict::kFail);
}

TEST(AcrossSeeds, RanksFailAboveDiffersAndSkipped) {
  std::vector<SeedOutcome> seeds = {seed_with(1, 1.1), seed_with(2, 1.1)};
  seeds[0].outcome.differs = true;
  EXPECT_EQ(across_seeds(seeds).verdict(), Verdict::kDiffers);
  EXPECT_THAT(across_seeds(seeds).measured, testing::HasSubstr("1 of 2 seeds pass, 1 differ; "));
  seeds[1].outcome.passed = false;
  EXPECT_EQ(across_seeds(seeds).verdict(), Verdict::kFail);
  for (SeedOutcome& each : seeds) {
    each.outcome = {};
    each.outcome.skipped = true;
  }
  EXPECT_EQ(across_seeds(seeds).verdict(), Verdict::kSkipped);
}

TEST(Conditions, GiveDistinctSeedsToAllRuns) {
  EXPECT_EQ(Conditions{}.seed_of_run(0, 3), 1u);
  EXPECT_EQ(Conditions{}.seed_of_run(2, 3), 3u);
  Conditions second;
  second.seed = 2;
  EXPECT_EQ(second.seed_of_run(0, 3), 4u);
}

TEST(Conditions, ChangeOnlyTheSeedOfARun) {
  Conditions conditions;
  conditions.seed = 2;
  conditions.recordings = "recordings";
  const Conditions third = conditions.of_run(2, 3);
  EXPECT_EQ(third.seed, conditions.seed_of_run(2, 3));
  EXPECT_EQ(third.recordings, conditions.recordings);
}

}  // namespace
}  // namespace throng::validation::across_seeds_test
