// How people move and stand: accelerations, queues, audiences, crowds that stand close.
#include "analysis/validation/behaviour.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "analysis/validation/recorded_inflow.h"
#include "analysis/validation/recorded_setups.h"
#include "analysis/validation/setups.h"
#include "analysis/validation/trial.h"
#include "scenes/retargeting/tracks.h"

namespace throng::validation {
namespace {

constexpr double kSeconds = 20;
constexpr double kSetUpSeconds = 60;

Outcome accelerations(const Conditions& conditions) {
  Outcome outcome;
  std::vector<SceneAccelerations> all;
  for (const char* name : {"plaza", "corridor", "crossing", "rush_hour"})
    all.push_back(accelerations_of(name, bundled_plan(name, conditions), kSeconds, outcome));
  for (const char* id : {"ug", "uo", "eo", "ko", "bot", "single_file"}) {
    const RecordedRun run = recorded_run(id, recorded_runs(id) - 1, conditions);
    all.push_back(accelerations_of(id, run.plan, kSetUpSeconds, outcome));
  }
  return judged(std::move(outcome), judge_accelerations(all));
}

Outcome queues(const Conditions& conditions) {
  constexpr double kDoor_m = 0.9;
  Outcome outcome;
  std::vector<QueueTurning> all;
  all.push_back(measure_queue("bottleneck", bundled_plan("bottleneck", conditions),
                              {{-12.2, -5.2}, {0, 5.2}}, 60, outcome));
  all.push_back(measure_queue("door of 0.9 m",
                              door_plan(kDoor_m, 180, conditions.model, conditions.seed),
                              {{0, -3}, {16, 3}}, 60, outcome));
  return judged(std::move(outcome), judge_queues(all));
}

Outcome audience(const Conditions& conditions) {
  constexpr double kConcert_s = 10;  // then the last song is over
  Outcome outcome;
  const std::vector<double> shares =
      facing_shares(bundled_plan("concert", conditions), kConcert_s, outcome);
  return judged(std::move(outcome), judge_audience(shares));
}

Outcome standing(const Conditions& conditions) {
  Outcome outcome;
  std::vector<DenseStanding> all;
  for (const double per_m2 : {0.5, 2.0, 4.0, 6.0})
    all.push_back(place_dense_crowd(per_m2, conditions, outcome));
  return judged(std::move(outcome), judge_standing(all));
}

}  // namespace

std::vector<Test> behaviour_tests() {
  return {
      {{"accelerations"},
       {"Accelerations over a tenth of a second"},
       "The bundled scenes plaza, corridor, crossing and rush_hour for 20 s, the fullest run of "
       "each set-up of speed against density for 60 s; second differences of places 0.1 s apart.",
       "below 5 m/s2 in 99.9 % in each of them (source: ours)",
       accelerations},
      {{"queues"},
       {"People in a queue hardly turn"},
       "The bundled scene bottleneck, and 180 people before a door of 0.9 m, for 60 s; people "
       "slower than 0.2 m/s before the door.",
       "at most one turn a person and minute net: there and back is nothing (source: ours; people "
       "in a queue face its way)",
       queues},
      {{"audience"},
       {"An audience faces the stage"},
       "The bundled scene concert until its last song is over, 10 s; ten times a second.",
       "at every moment 95 % face the stage within 20 degrees (source: ours)",
       audience},
      {{"standing_density"},
       {"People stand as close as asked"},
       "A crowd of `density_per_m2` 0.5, 2, 4 and 6 on 6 m x 6 m in the middle of a hall.",
       "as many as asked, to within 1 %, bodies seen from above less than 1 cm in each other "
       "(source: ours; 6 per m2 is where bodies begin to press into each other)",
       standing}};
}

namespace {

constexpr double kWalkedWithin_s = 300;
/// Fifteen parties are few: one crowd's share at the door differs from another's by two in a
/// hundred.
constexpr uint64_t kDoorCrowds = 3;

GroupCohesion keep_together_at_a_door(const Conditions& conditions, Outcome& outcome) {
  GroupCohesion all{"door of 1 m", 0, 0};
  for (uint64_t crowd = 0; crowd < kDoorCrowds; ++crowd) {
    const uint64_t seed = conditions.seed_of_run(crowd, kDoorCrowds);
    const GroupCohesion one = measure_cohesion(
        all.where, groups_at_a_door_plan(conditions.model, seed), kWalkedWithin_s, outcome);
    all.moments += one.moments;
    all.close += one.close;
  }
  return all;
}

Outcome companions(const Conditions& conditions) {
  const SteeringKind model = conditions.model;
  const uint64_t seed = conditions.seed;
  Outcome outcome;
  const std::vector<GroupCohesion> places = {
      measure_cohesion("crossing", crossing_groups_plan(model, seed), kWalkedWithin_s, outcome),
      keep_together_at_a_door(conditions, outcome)};
  const GroupExits exits =
      measure_group_exits(groups_with_two_exits_plan(model, seed), 2 * kWalkedWithin_s, outcome);
  return judged(std::move(outcome), judge_social_groups(places, exits));
}

}  // namespace

std::vector<Test> social_group_tests() {
  return {{{"companions"},
           {"Companions stay together"},
           "Parties of two, three and four, every person in one: 54 in two streams that cross at "
           "right angles, 15 through a door of 1 m and 20 m on in three crowds, 60 out of a hall "
           "of 30 m x 20 m "
           "with two exits of 1 m, all in the half with one of them.",
           "within 3 m of a companion 95 % of the time, 95 % of the parties leave by one exit, and "
           "everybody leaves (source: ours; who walks together keeps 0.75 to 0.8 m apart: Moussaid "
           "et al. 2010, Zanlungo et al. 2014)",
           companions}};
}

namespace {

constexpr uint64_t kEncounters = 1000;
/// All bundled scenes of people who walk, but for the one with 100 000.
constexpr std::array kScenes = {"bottleneck",   "corridor",        "crossing", "evacuation",
                                "metro",        "plaza",           "ring",     "rush_hour",
                                "stadium_exit", "station_platform"};
constexpr double kScene_s = 20;
/// One crowd's contacts differ from another's by a tenth. So many crowds spend half an hour at the
/// densest level in two scenes.
constexpr uint64_t kSceneCrowds = 4;
/// Through the corridor and the door people are within a minute and a half. So many crowds spend
/// half an hour at all levels but the lowest.
constexpr double kWalkedAgain_s = 90;
constexpr uint64_t kContactCrowds = 6;
/// Recorded contacts are those of our bodies on other people's tracks, which the bodies do not fit:
/// below this density people need not touch as often, except on the recordings' own ground, where
/// steering has to bring them together as those people came together.
constexpr double kTwoSidedFrom_per_m2 = 2;

Outcome encounters(const Conditions& conditions) {
  return judged({}, judge_encounters(simulate_encounters(kEncounters, conditions)));
}

Outcome contacts(const Conditions& conditions) {
  std::vector<PlaceContacts> scenes;
  for (const char* name : kScenes) {
    PlaceContacts& scene = scenes.emplace_back(PlaceContacts{name, {}});
    for (uint64_t crowd = 0; crowd < kSceneCrowds; ++crowd)
      scene.add(contacts_of(bundled_plan(name, conditions.of_run(crowd, kSceneCrowds)), kScene_s));
  }
  return judged({}, judge_contacts(scenes, kTwoSidedFrom_per_m2));
}

/// Density alone does not tell how often people touch: here it is the recordings' own geometry and
/// inflow.
Outcome contacts_walked_again(const Conditions& conditions) {
  Outcome outcome;
  std::vector<PlaceContacts> sites;
  for (const char* id : kInflowSites) {
    const auto recording = recording_of(inflow_site(id, conditions), conditions, outcome);
    if (recording == nullptr) return outcome;
    PlaceContacts& place = sites.emplace_back(PlaceContacts{id, {}});
    for (uint64_t crowd = 0; crowd < kContactCrowds; ++crowd) {
      const InflowSite site = inflow_site(id, conditions.of_run(crowd, kContactCrowds));
      place.add(contacts_of(with_inflow(site, *recording), kWalkedAgain_s));
    }
  }
  return judged(std::move(outcome), judge_contacts(sites, 0));
}

}  // namespace

std::vector<Test> contact_tests() {
  return {
      {{"encounters"},
       {"Two who meet do not touch"},
       "1000 random encounters of two adults on empty ground, a third head-on, crossing and the "
       "same way each, at 0.6 to 1.8 m/s, whose middles would pass at 0 to 0.6 m; steered, with "
       "bodies that give way, for 9 s; contacts by triangles.",
       "nobody touches (source: ours; two people with room around them do not)",
       encounters},
      {{"contacts"},
       {"How often people touch, by density"},
       fmt::format("The bundled scenes {} for 20 s, four crowds each; contacts of two people by "
                   "triangles, by the people within 2 m. Whoever came in within the last "
                   "{} s does not count.",
                   fmt::join(kScenes, ", "), kExpected_s),
       fmt::format(
           "contacts by person-minutes of all scenes together, at each level with 30 "
           "person-minutes: at most 1 a person and minute below 0.43 per m2, elsewhere at most "
           "1.5 times the recorded or 0.5 more; from {:g} per m2 on also at least 0.5 times the "
           "recorded; not falling from level to level by more than chance (95 %); three levels at "
           "least, one of them from {:g} per m2 on; source: {}",
           kTwoSidedFrom_per_m2, kTwoSidedFrom_per_m2, kRecordedContactsSource),
       contacts},
      {{"contacts_walked_again"},
       {"How often people touch where recorded people did"},
       "The set-ups of the three recordings, with their own inflow, for 90 s, six crowds each; "
       "contacts as for contacts, all set-ups taken together, as the recordings are.",
       fmt::format(
           "as for contacts, and at every level from 0.43 per m2 on also at least 0.5 times "
           "the recorded or 0.5 less; source: {}",
           kRecordedContactsSource),
       contacts_walked_again}};
}

}  // namespace throng::validation
