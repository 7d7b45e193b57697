// Verdicts on behaviour can fail, and the measures of behaviour see what the scenes contain.
#include "analysis/validation/behaviour.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "analysis/validation/recorded_inflow.h"

namespace throng::validation::behaviour_test {
namespace {

TEST(AccelerationVerdict, FailsForOneSceneAboveTheLimit) {
  EXPECT_TRUE(judge_accelerations(std::vector<SceneAccelerations>{{"a", 4.9, 1000}}).passed);
  EXPECT_FALSE(
      judge_accelerations(std::vector<SceneAccelerations>{{"a", 3, 1000}, {"b", 5.1, 1000}})
          .passed);
  EXPECT_FALSE(judge_accelerations({}).passed);
}

TEST(QueueVerdict, FailsForTurningPeopleAndForTooFew) {
  EXPECT_TRUE(judge_queues(std::vector<QueueTurning>{{"a", 9, 99, 600}}).passed);
  EXPECT_FALSE(judge_queues(std::vector<QueueTurning>{{"a", 11, 99, 600}}).passed);
  EXPECT_FALSE(judge_queues(std::vector<QueueTurning>{{"a", 0, 0, 299}}).passed);
  EXPECT_FALSE(judge_queues({}).passed);
}

TEST(AudienceVerdict, FailsForOneMomentBelowTheShare) {
  EXPECT_TRUE(judge_audience(std::vector<double>{1, 0.96, 1}).passed);
  EXPECT_FALSE(judge_audience(std::vector<double>{1, 0.94, 1}).passed);
  EXPECT_FALSE(judge_audience({}).passed);
}

TEST(StandingVerdict, FailsForLowDensityAndForOverlappingBodies) {
  EXPECT_TRUE(judge_standing(std::vector<DenseStanding>{{4, 3.97, 0.005}}).passed);
  EXPECT_FALSE(judge_standing(std::vector<DenseStanding>{{4, 3.9, -0.1}}).passed);
  EXPECT_FALSE(judge_standing(std::vector<DenseStanding>{{4, 4, 0.02}}).passed);
}

TEST(EncounterVerdict, FailsForASingleContact) {
  std::vector<EncounterOutcome> met(100, {EncounterKind::kCrossing, 0.4, false});
  EXPECT_TRUE(judge_encounters(met).passed) << "bodies avoid each other at 0.4 m";
  met[50].touched = true;
  EXPECT_FALSE(judge_encounters(met).passed);
  EXPECT_FALSE(judge_encounters({}).passed);
}

CountedContacts at_rate(double per_person_min, double person_min = 60) {
  return {static_cast<uint64_t>(std::lround(per_person_min * person_min / 2)), 60 * person_min};
}

/// Recorded rates, with an hour at each level.
PlaceContacts recorded_place() {
  PlaceContacts place{"as recorded", {}};
  for (const RecordedContacts& recorded : recorded_contacts())
    place.levels.push_back(at_rate(recorded.per_person_min));
  return place;
}

PlaceContacts with_rate(size_t level, double per_person_min, double person_min = 60) {
  PlaceContacts place = recorded_place();
  place.levels[level] = at_rate(per_person_min, person_min);
  return place;
}

constexpr double kFromDense_per_m2 = 2;

/// Judges as the test `contacts`; the next function as `contacts_walked_again`.
bool pass(const std::vector<PlaceContacts>& places) {
  return judge_contacts(places, kFromDense_per_m2).passed;
}
bool pass_walked_again(const std::vector<PlaceContacts>& places) {
  return judge_contacts(places, 0).passed;
}

TEST(ContactVerdict, PassesForRecordedRates) {
  EXPECT_TRUE(pass({recorded_place()}));
  EXPECT_TRUE(pass_walked_again({recorded_place()}));
}

TEST(ContactVerdict, FailsAboveTheUpperBoundOfAnyLevel) {
  for (size_t i = 0; i < recorded_contacts().size(); ++i) {
    const double bound = i == 0 ? 1 : 1.5 * recorded_contacts()[i].per_person_min;
    for (const auto& passes : {pass, pass_walked_again}) {
      EXPECT_TRUE(passes({with_rate(i, 0.99 * bound, 1000)})) << "level " << i;
      EXPECT_FALSE(passes({with_rate(i, 1.01 * bound, 1000)})) << "level " << i;
    }
  }
}

TEST(ContactVerdict, FailsBelowTheLowerBoundFromTwoPerSquareMetre) {
  for (const size_t i : {3u, 4u}) {
    const double bound = 0.5 * recorded_contacts()[i].per_person_min;
    for (const auto& passes : {pass, pass_walked_again}) {
      EXPECT_FALSE(passes({with_rate(i, 0.99 * bound, 1000)})) << "level " << i;
      EXPECT_TRUE(passes({with_rate(i, 1.01 * bound, 1000)})) << "level " << i;
    }
  }
  EXPECT_FALSE(pass({with_rate(3, 7)})) << "3 per m2";
}

TEST(ContactVerdict, FailsBelowTheLowerBoundOfSparseLevelsOnRecordedGroundOnly) {
  PlaceContacts few = with_rate(1, 0.4);  // 0.5 per m2; the lower bound is 1.1
  EXPECT_TRUE(pass({few}));
  EXPECT_FALSE(pass_walked_again({few}));
  few = with_rate(2, 2.5);  // 1.5 per m2; the lower bound is 2.7
  EXPECT_TRUE(pass({few}));
  EXPECT_FALSE(pass_walked_again({few}));
  EXPECT_TRUE(pass_walked_again({with_rate(0, 0)})) << "the lowest level has no lower bound above "
                                                       "0";
}

TEST(ContactVerdict, ReportsALowerBoundOnlyWhereItIsJudged) {
  const Judgement contacts = judge_contacts(std::vector{recorded_place()}, kFromDense_per_m2);
  const Judgement again = judge_contacts(std::vector{recorded_place()}, 0);
  const auto lows = [](const Judgement& judgement) {
    std::vector<double> out;
    for (const Reading& reading : judgement.readings)
      if (reading.met && reading.what == "contacts")
        out.push_back(std::isnan(reading.low) ? -1 : reading.low);
    return out;
  };
  using testing::DoubleNear;
  EXPECT_THAT(lows(contacts),
              testing::ElementsAre(-1, -1, -1, DoubleNear(8.2, 1e-9), DoubleNear(25.6, 1e-9)));
  EXPECT_THAT(lows(again), testing::ElementsAre(0, DoubleNear(1.1, 1e-9), DoubleNear(2.7, 1e-9),
                                                DoubleNear(8.2, 1e-9), DoubleNear(25.6, 1e-9)));
}

TEST(ContactVerdict, FailsIfRatesFallBeyondChance) {
  PlaceContacts place = recorded_place();
  // 3.2 per minute at 0.43 to 1 per m2 and 2.8 at 1 to 2: each within its bounds.
  place.levels[1] = at_rate(3.2, 600);
  place.levels[2] = at_rate(2.8, 600);
  EXPECT_FALSE(pass({place}));
  EXPECT_FALSE(pass_walked_again({place}));
  place.levels[2] = at_rate(3.15, 600);
  EXPECT_TRUE(pass({place})) << "a fall of 2 % is chance";
}

TEST(ContactVerdict, FailsForACrowdThatIsNeverDense) {
  PlaceContacts place = recorded_place();
  place.levels.resize(2);
  EXPECT_FALSE(pass({place}));
  EXPECT_FALSE(pass_walked_again({place}));
}

TEST(ContactVerdict, FailsWithoutALevelThatHasALowerBound) {
  PlaceContacts place = recorded_place();
  place.levels.resize(3);  // up to 2 per m2
  EXPECT_FALSE(pass({place})) << "three levels with upper bounds only";
  EXPECT_TRUE(pass_walked_again({place}));
}

TEST(ContactVerdict, PoolsAllPlacesByPersonTime) {
  // 4.5 per minute for 9 of 10 people, 0.1 for the others: the mean of places, 2.3, is within
  // bounds.
  const PlaceContacts full = with_rate(1, 4.5, 900), empty = with_rate(1, 0.1, 100);
  EXPECT_FALSE(pass({full, empty}));
  EXPECT_FALSE(pass_walked_again({full, empty}));
  // At 3 per m2, 5 for 9 of 10 people and 20 for the others are 6.5 for all, but 12.5 by place.
  EXPECT_FALSE(pass({with_rate(3, 5, 900), with_rate(3, 20, 100)}));
  // Ten places above the bound, and one with most of the people that compensates.
  std::vector<PlaceContacts> places(10, with_rate(1, 4, 10));
  places.push_back(with_rate(1, 2, 1000));
  EXPECT_TRUE(pass(places));
  EXPECT_TRUE(pass_walked_again(places));
}

TEST(ContactVerdict, SkipsLevelsWithLessThanHalfAnHourInTotal) {
  PlaceContacts place = recorded_place(), brief = recorded_place();
  place.levels[4] = brief.levels[4] = at_rate(999, 14.9);
  EXPECT_TRUE(pass({place, brief})) << "29.8 min";
  place.levels[4] = at_rate(999, 15.2);
  EXPECT_FALSE(pass({place, brief})) << "30.1 min in total, fewer in each place";
  EXPECT_FALSE(pass({}));
}

TEST(SocialGroupVerdict, FailsForScatteredAndForSplitGroups) {
  const std::vector<GroupCohesion> together = {{"a", 1000, 960}},
                                   far = {{"a", 1000, 960}, {"b", 1000, 940}};
  EXPECT_TRUE(judge_social_groups(together, {100, 96, 0}).passed);
  EXPECT_FALSE(judge_social_groups(far, {100, 96, 0}).passed);
  EXPECT_FALSE(judge_social_groups(together, {100, 94, 0}).passed);
  EXPECT_FALSE(judge_social_groups(together, {100, 100, 1}).passed);
  EXPECT_FALSE(judge_social_groups({}, {100, 100, 0}).passed);
}

TEST(SocialGroupPlans, PlaceEachGroupTogether) {
  for (const Plan& plan : {crossing_groups_plan(SteeringRule{}.model, 1),
                           groups_at_a_door_plan(SteeringRule{}.model, 1),
                           groups_with_two_exits_plan(SteeringRule{}.model, 1)}) {
    const Trial trial(plan);
    EXPECT_EQ(trial.unplaced(), 0) << plan.scene.name;
    for (size_t id = 1; id < trial.size(); ++id) {
      if (trial.group(id) != trial.group(id - 1)) continue;
      EXPECT_LT((trial.position_m(id) - trial.position_m(id - 1)).norm(), 3) << plan.scene.name;
    }
  }
}

TEST(GroupCohesion, IsLowerWithoutSocialGroups) {
  Plan plan("apart", {{-20, -4}, {20, 4}}, {}, 1);
  Group& group = plan.people(2, {{-1, -1}, {1, 1}}, {{{15, -4}, {20, 4}}});
  group.social_groups = SocialGroupRule{1, {1, 0, 0}};
  Outcome outcome;
  EXPECT_GT(measure_cohesion("together", plan, 30, outcome).share(), 0.95);
  // One group without social groups, with different speeds.
  group.social_groups.reset();
  group.speed_mps = Distribution{1.2, 0.6, 0.5, 2};
  plan.scene.seed = 3;
  EXPECT_LT(measure_cohesion("apart", plan, 30, outcome).share(), 0.95);
}

std::vector<SpeedAndSpacing::Spacing> cells(double shift_m) {
  return {{"1 to 2", true, 600, {0.4 + shift_m, 0.5 + shift_m, 0.7 + shift_m}},
          {"1 to 2", false, 600, {0.3, 0.4, 0.6}},
          {"2 to 3", true, 499, {0.1, 0.1, 0.1}}};
}

TEST(SpacingVerdict, FailsNineCentimetresOffAndForASparseCrowd) {
  EXPECT_TRUE(judge_spacing(cells(0.07), cells(0)).passed);
  EXPECT_FALSE(judge_spacing(cells(0.09), cells(0)).passed);
  EXPECT_FALSE(judge_spacing(cells(-0.09), cells(0)).passed);
  auto few = cells(0);
  few[0].pairs = 499;
  EXPECT_TRUE(judge_spacing(few, cells(0)).passed) << "half of the cells is enough";
  few[1].pairs = 499;
  EXPECT_FALSE(judge_spacing(few, cells(0)).passed);
}

TEST(SpacingVerdict, AllowsALargerDeviationAtOnePercent) {
  auto simulated = cells(0);
  simulated[0].quantiles_m[0] += 0.11;
  EXPECT_TRUE(judge_spacing(simulated, cells(0)).passed);
  simulated[0].quantiles_m[0] += 0.02;
  EXPECT_FALSE(judge_spacing(simulated, cells(0)).passed);
}

TEST(RecordedInflow, IsSkippedWithoutRecordings) {
  std::vector<validation::Test> tests = spacing_tests();
  tests.push_back(contact_tests().back());
  for (const validation::Test& test : tests) {
    SCOPED_TRACE(test.ids[0]);
    const Outcome outcome = run_test(test, {});
    EXPECT_EQ(outcome.verdict(), Verdict::kSkipped);
    EXPECT_THAT(outcome.measured, testing::HasSubstr("--recordings"));
  }
}

/// Runs only if the recordings are available.
TEST(RecordedInflow, AddsEachPersonAtTheRecordedTimeAndPlace) {
  const char* const folder = std::getenv("THRONG_RECORDINGS");
  if (folder == nullptr) GTEST_SKIP() << "THRONG_RECORDINGS names no folder of recordings";
  for (const char* id : kInflowSites) {
    const InflowSite site = inflow_site(id, {});
    Outcome outcome;
    const auto recording = recording_of(site, {.recordings = folder}, outcome);
    const Plan plan = with_inflow(site, *recording);
    Trial trial(plan);
    ASSERT_EQ(trial.size(), recording->people().size()) << id;
    std::vector<double> came_s(trial.size(), -1);
    while (trial.step(120))
      for (size_t i = 0; i < trial.size(); ++i)
        if (trial.is_present(i) && came_s[i] < 0) came_s[i] = trial.now_s();
    std::vector<double> firsts_s;
    for (const RecordedPerson& person : recording->people()) firsts_s.push_back(person.first_s);
    std::sort(firsts_s.begin(), firsts_s.end());
    std::sort(came_s.begin(), came_s.end());
    double sum_s = 0;
    for (size_t i = 0; i < came_s.size(); ++i) {
      EXPECT_GE(came_s[i], firsts_s[i] - 0.06) << id;
      sum_s += came_s[i] - firsts_s[i];
    }
    EXPECT_LT(sum_s / static_cast<double>(came_s.size()), 1) << id;
    EXPECT_EQ(trial.present(), 0u) << id;
  }
}

TEST(MeasuredAccelerations, IncludeAWalkerWhoTurnsBack) {
  Plan plan("alone", {{0, 0}, {20, 2}}, {}, 1);
  Group& group = plan.people(1, {{1, 0.9}, {1.2, 1.1}}, {{{18, 0}, {20, 2}}});
  Outcome outcome;
  const SceneAccelerations straight = accelerations_of("alone", plan, 10, outcome);
  EXPECT_EQ(straight.samples, 99u);
  EXPECT_LT(straight.at_999_mps2, 0.1);
  group.goals[0].areas = {{{6, 0}, {8, 2}}};
  group.goals.push_back(group.goals[0]);
  group.goals[1].areas = {{{0, 0}, {1, 2}}};
  const SceneAccelerations found = accelerations_of("alone", plan, 10, outcome);
  EXPECT_GT(found.at_999_mps2, 0.5);
  EXPECT_LT(found.at_999_mps2, 5);
}

TEST(MeasuredQueue, CoversOnlyPeopleInFrontOfTheDoor) {
  Plan plan("closed", {{0, 0}, {10, 4}}, {}, 1);
  plan.wall_along_y(0, 4, 8, {2}, 0.7);
  plan.people(30, {{0.5, 0.5}, {7, 3.5}}, {{{9, 0}, {10, 4}}});
  Outcome outcome;
  const QueueTurning before = measure_queue("before", plan, {{0, 0}, {8, 4}}, 20, outcome);
  const QueueTurning behind = measure_queue("behind", plan, {{8.2, 0}, {10, 4}}, 20, outcome);
  EXPECT_GT(before.waited_s, 30);
  EXPECT_LT(behind.waited_s, 0.1 * before.waited_s);
  EXPECT_GE(before.all_turns, before.net_turns);
}

TEST(FacingShares, CountPeopleWhoFaceThePointOfTheirGroup) {
  Plan plan("hall", {{0, 0}, {20, 20}}, {}, 1);
  Group& group = plan.people(20, {{4, 4}, {16, 16}}, {{{0, 0}, {20, 2}}});
  group.premovement_s = fixed(100);
  group.look_at_m = Eigen::Vector2d(10, 25);
  Outcome outcome;
  const std::vector<double> shares = facing_shares(plan, 2, outcome);
  ASSERT_EQ(shares.size(), 21u);
  for (const double share : shares) EXPECT_GE(share, 0.95);
  plan.scene.groups[0].look_at_m.reset();
  EXPECT_TRUE(facing_shares(plan, 2, outcome).empty()) << "no audience";
}

TEST(SimulatedEncounters, StartAsDrawnAndAreReproducible) {
  const std::vector<EncounterOutcome> met = simulate_encounters(10, {});
  ASSERT_EQ(met.size(), 10u);
  for (size_t i = 0; i < met.size(); ++i) {
    EXPECT_EQ(met[i].kind, Encounter(1, i).kind());
    EXPECT_GT(met[i].nearest_m, 0.2) << i;
    EXPECT_LT(met[i].nearest_m, 4) << i << ": closest approach";
  }
  const std::vector<EncounterOutcome> again = simulate_encounters(10, {});
  for (size_t i = 0; i < met.size(); ++i) EXPECT_EQ(met[i].nearest_m, again[i].nearest_m);
}

}  // namespace
}  // namespace throng::validation::behaviour_test
