// The fast standard tests, and the instruments that all standard tests use.
#include "analysis/validation/validation.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "analysis/validation/empirical_tables.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/verdicts.h"

namespace throng::validation::validation_test {
namespace {

const Test& test_of(const std::string& id) {
  for (const Test& test : all_tests())
    if (test.has(id)) return test;
  throw std::runtime_error("no test " + id);
}

class Standard : public testing::TestWithParam<const char*> {};

TEST_P(Standard, IsMet) {
  const Outcome outcome = run_test(test_of(GetParam()), {});
  EXPECT_TRUE(outcome.passed) << outcome.measured;
  EXPECT_EQ(outcome.wall_crossings, 0);
  EXPECT_EQ(outcome.unplaced, 0);
}

// Tests of about 1 s each; `throng validate` runs all others.
INSTANTIATE_TEST_SUITE_P(Validation, Standard,
                         testing::Values("rimea_1", "imo_1", "rimea_5", "rimea_6", "rimea_7",
                                         "imo_4"),
                         [](const auto& each) { return std::string(each.param); });

TEST(StandardTests, HaveUniqueIdsAndACriterion) {
  std::set<std::string> ids, figures;
  for (const validation::Test& test : all_tests()) {
    ASSERT_EQ(test.ids.size(), test.titles.size());
    EXPECT_FALSE(test.setup.empty() || test.criterion.empty()) << test.ids.front();
    for (const std::string& id : test.ids) {
      EXPECT_TRUE(ids.insert(id).second) << id;
      EXPECT_EQ(normal_id(id), id);
    }
  }
  for (const char* id :
       {"rimea_1", "rimea_4", "rimea_5", "rimea_6", "rimea_7", "rimea_9", "rimea_12", "imo_1",
        "imo_4", "imo_5", "imo_6", "imo_8", "imo_9", "iso_4", "iso_5", "iso_6", "iso_11"})
    EXPECT_TRUE(ids.contains(id)) << id;
  EXPECT_EQ(normal_id("RiMEA 12"), "rimea_12");
}

TEST(StandardTests, AreReproducible) {
  EXPECT_EQ(run_test(test_of("rimea_6"), {}).measured, run_test(test_of("rimea_6"), {}).measured);
}

TEST(Weidmann, MatchesTheLiterature) {
  EXPECT_NEAR(weidmann_mps(0.5), 1.298, 1e-3);
  EXPECT_NEAR(weidmann_mps(1), 1.058, 1e-3);
  EXPECT_NEAR(weidmann_mps(2), 0.606, 1e-3);
  EXPECT_NEAR(weidmann_mps(3), 0.331, 1e-3);
  EXPECT_NEAR(weidmann_mps(4), 0.156, 1e-3);
  EXPECT_EQ(weidmann_mps(6), 0);
}

/// The necks of RiMEA 12, with a queue of 2.3 per m2 before the exit of the second room.
std::vector<NeckPassage> queue_before_the_exit() {
  const Crowding jam{6, 0.8, 0.6}, queue{2.3, 0.4, 0};
  return {{0.8, 1.4, true, jam, queue}, {1, 1.8, true, jam, queue}, {1.2, 2, true, jam, jam}};
}

Verdict verdict_of(const std::vector<NeckPassage>& necks) {
  return judged({}, judge_necks(necks, 1)).verdict();
}

TEST(NeckVerdict, DiffersForAQueueBeforeTheExit) {
  std::vector<NeckPassage> necks = queue_before_the_exit();
  EXPECT_EQ(verdict_of(necks), Verdict::kDiffers);
  EXPECT_THAT(judge_necks(necks, 1).summary,
              testing::HasSubstr("6.00 people per m2 over 10 s before the neck and 2.30 before the "
                                 "exit of the second room, where RiMEA expects no congestion: "
                                 "people queue (more than 1.75 per m2 for 40 % of the time"));
  necks[1].before_exit = {1.76, 0.01, 0};
  EXPECT_EQ(verdict_of(necks), Verdict::kDiffers) << "regardless of its duration";
  necks[1].before_exit = {1.74, 0, 0};
  EXPECT_EQ(verdict_of(necks), Verdict::kPass);
}

TEST(NeckVerdict, FailsForAJamBeforeTheExitAndForNoneBeforeTheNeck) {
  std::vector<NeckPassage> necks = queue_before_the_exit();
  necks[1].before_exit = {4.5, 0.5, 0.11};
  EXPECT_EQ(verdict_of(necks), Verdict::kFail);
  necks = queue_before_the_exit();
  necks[1].before_neck = {4.5, 0.5, 0.09};
  EXPECT_EQ(verdict_of(necks), Verdict::kFail);
}

TEST(NeckVerdict, FailsForAFlowThatDoesNotGrowAndForPeopleLeftBehind) {
  std::vector<NeckPassage> necks = queue_before_the_exit();
  necks[2].flow_per_s = necks[1].flow_per_s;
  EXPECT_EQ(verdict_of(necks), Verdict::kFail);
  necks = queue_before_the_exit();
  necks[0].all_through = false;
  EXPECT_EQ(verdict_of(necks), Verdict::kFail);
  EXPECT_EQ(verdict_of({}), Verdict::kFail);
  necks = queue_before_the_exit();
  necks.erase(necks.begin() + 1);
  EXPECT_EQ(verdict_of(necks), Verdict::kFail) << "no neck has the width of the exit";
}

TEST(NeckVerdict, DefinesQueuesByTheDensityOfMaximumFlow) {
  const auto flow = [](double per_m2) { return per_m2 * weidmann_mps(per_m2); };
  EXPECT_GT(flow(kQueue_per_m2), flow(kQueue_per_m2 - 0.05));
  EXPECT_GT(flow(kQueue_per_m2), flow(kQueue_per_m2 + 0.05));
}

/// Speeds in the middle of the recorded range at each density.
std::vector<UnidirectionalSpeed> recorded_speeds_of_one_way() {
  std::vector<UnidirectionalSpeed> points;
  for (const double per_m2 : {0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0}) {
    const auto band = recorded_one_way_at(per_m2).value();
    points.push_back({per_m2, per_m2, 0.5 * (band.low_mps + band.high_mps)});
  }
  return points;
}

TEST(UnidirectionalVerdict, NamesReadingsWithinTenPercentOfABound) {
  std::vector<UnidirectionalSpeed> points = recorded_speeds_of_one_way();
  EXPECT_THAT(judge_unidirectional(points).summary,
              testing::HasSubstr("6 of 6 as recorded; none within 10 % of a bound"));
  const RecordedBand band = recorded_one_way_at(2).value();
  for (const double factor : {1.01, 1.09}) {
    points[3].speed_mps = factor * band.low_mps;
    const Judgement judgement = judge_unidirectional(points);
    EXPECT_TRUE(judgement.passed);
    EXPECT_THAT(judgement.summary,
                testing::EndsWith(fmt::format("; within 10 % of a bound: "
                                              "{:.2f} m/s at 2 per m2 (at least {:.2f})",
                                              points[3].speed_mps, band.low_mps)));
  }
  points[3].speed_mps = 1.11 * band.low_mps;
  EXPECT_EQ(marginal_readings(judge_unidirectional(points).readings), "");
  points[3].speed_mps = 0.91 * band.high_mps;
  EXPECT_THAT(marginal_readings(judge_unidirectional(points).readings),
              testing::HasSubstr("at most"));
}

TEST(UnidirectionalVerdict, FailsOutsideABoundAndNamesTheReading) {
  std::vector<UnidirectionalSpeed> points = recorded_speeds_of_one_way();
  points[0].speed_mps = 9;
  points[5].speed_mps = 0.01;
  const Judgement judgement = judge_unidirectional(points);
  EXPECT_FALSE(judgement.passed);
  EXPECT_THAT(judgement.summary, testing::HasSubstr("4 of 6 as recorded; outside or within 10 %"));
  EXPECT_THAT(judgement.summary, testing::HasSubstr(", outside), 0.01 m/s at 3 per m2 (at least "));
  points = recorded_speeds_of_one_way();
  points[6].speed_mps = 9;
  EXPECT_TRUE(judge_unidirectional(points).passed) << "4 per m2 is reported only";
  EXPECT_EQ(marginal_readings(judge_unidirectional(points).readings), "");
  points[0].density_per_m2 = 0.1;
  EXPECT_FALSE(judge_unidirectional(points).passed) << "no recordings at this density";
  EXPECT_FALSE(judge_unidirectional({}).passed);
}

TEST(FlowPerSecond, DividesThePeopleAfterTheFirstByTheirTime) {
  EXPECT_DOUBLE_EQ(flow_per_s({10, 11, 12, 13}), 1);
  EXPECT_EQ(flow_per_s({5}), 0);
}

TEST(Gate, RecordsTheFirstPassageOfEachPerson) {
  Plan plan("gate", {{0, 0}, {20, 2}}, {}, 1);
  Group& walker = plan.people(1, {{1, 0.9}, {1.2, 1.1}}, {{{18, 0}, {20, 2}}});
  walker.speed_mps = fixed(1);
  Trial trial(plan);
  Gate front(Gate::Along::kX, 5, 0, 2);
  Gate far(Gate::Along::kX, 15, 0, 2);
  Gate outside(Gate::Along::kX, 10, 1.8, 2);
  Gate backwards(Gate::Along::kX, 10, 0, 2, false);
  while (trial.step(60))
    for (Gate* gate : {&front, &far, &outside, &backwards}) gate->watch(trial);
  ASSERT_EQ(front.passages().size(), 1u);
  ASSERT_EQ(far.passages().size(), 1u);
  EXPECT_NEAR(far.times_s()[0] - front.times_s()[0], 10, 0.05);
  EXPECT_TRUE(outside.passages().empty());
  EXPECT_TRUE(backwards.passages().empty());
  EXPECT_EQ(trial.present(), 0u) << "people leave on arrival";
}

TEST(Trial, CountsNoCrossingIfWallsStopPeople) {
  // A box without a door: no person reaches the goal or passes a wall.
  Plan plan("cell", {{0, 0}, {10, 4}}, {}, 1);
  plan.wall_along_y(0, 4, 5, {}, 1);
  plan.people(4, {{0.5, 0.5}, {4.5, 3.5}}, {{{8, 0}, {10, 4}}});
  Trial trial(plan);
  while (trial.step(5)) continue;
  EXPECT_EQ(trial.wall_crossings(), 0);
  for (size_t id = 0; id < trial.size(); ++id) EXPECT_LT(trial.position_m(id).x(), 5);
}

TEST(Plan, PlacesTheRequestedNumberOfPeopleInRows) {
  Plan plan("rows", {{0, 0}, {12, 5}}, {}, 1);
  plan.people_in_rows(10, 10, {{0, 0}, {8, 5}}, {{{10.5, 0}, {12, 5}}});
  const Trial trial(plan);
  EXPECT_EQ(trial.size(), 100u);
  EXPECT_EQ(trial.unplaced(), 0);
}

}  // namespace
}  // namespace throng::validation::validation_test
