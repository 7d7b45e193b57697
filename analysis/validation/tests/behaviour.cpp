// Tests of motion and standing: accelerations, queues, audiences, dense crowds, groups, contacts.
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
  constexpr double kConcert_s = 10;  // end of the last song
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
       {"Accelerations over 0.1 s"},
       "The bundled scenes plaza, corridor, crossing and rush_hour for 20 s, the densest run of "
       "each setup of speed against density for 60 s; second differences of positions 0.1 s apart.",
       "below 5 m/s2 in 99.9 % in each of them (source: Throng)",
       accelerations},
      {{"queues"},
       {"People in a queue do not turn round"},
       "The bundled scene bottleneck, and 180 people before a door of 0.9 m, for 60 s; people "
       "slower than 0.2 m/s in front of the door.",
       "at most one net turn per person and minute (source: Throng; people "
       "in a queue face along it)",
       queues},
      {{"audience"},
       {"An audience faces the stage"},
       "The bundled scene concert until its last song is over, 10 s; 10 times per second.",
       "at every moment 95 % face the stage within 20 degrees (source: Throng)",
       audience},
      {{"standing_density"},
       {"People stand as densely as requested"},
       "A crowd of `density_per_m2` 0.5, 2, 4 and 6 on 6 m x 6 m in the middle of a hall.",
       "density within 1 %, bodies seen from above overlap by less than 1 cm "
       "(source: Throng; from 6 per m2 on bodies press against each other)",
       standing}};
}

namespace {

constexpr double kWalkedWithin_s = 300;
/// Fifteen groups are few: shares at the door differ between crowds by 2 %.
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

Outcome social_groups(const Conditions& conditions) {
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
  return {{{"social_groups"},
           {"Members of social groups stay together"},
           "Social groups of two, three and four people: 54 groups in two streams that cross at "
           "right angles, 15 through a door of 1 m and 20 m beyond (three crowds), 60 out of a "
           "hall "
           "of 30 m x 20 m "
           "with two exits of 1 m, all starting in the half with one of them.",
           "within 3 m of a member 95 % of the time, 95 % of the groups leave by one exit, and all "
           "people leave (source: Throng; members keep 0.75 to 0.8 m apart: Moussaid "
           "et al. 2010, Zanlungo et al. 2014)",
           social_groups}};
}

namespace {

constexpr uint64_t kEncounters = 1000;
/// All bundled scenes with walking people, except the one with 100 000.
constexpr std::array kScenes = {"bottleneck",   "corridor",        "crossing", "evacuation",
                                "metro",        "plaza",           "ring",     "rush_hour",
                                "stadium_exit", "station_platform"};
constexpr double kScene_s = 20;
/// Contacts differ between crowds by a tenth. This number of crowds gives half an hour at the
/// densest level of two scenes.
constexpr uint64_t kSceneCrowds = 4;
/// People cross the corridor and the door within 90 s. This number of crowds gives half an hour at
/// all levels except the lowest.
constexpr double kWalkedAgain_s = 90;
constexpr uint64_t kContactCrowds = 6;
/// Recorded contacts are those of retargeted bodies, which do not fit the tracks. Below this
/// density the rates may be lower, except on the recordings' own ground, where steering must bring
/// people together as recorded.
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

/// Compares contacts on the geometry and with the inflow of the recordings, because density alone
/// does not determine their rate.
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
       {"Two people who meet do not touch"},
       "1000 random encounters of two adults on empty ground, one third each head-on, crossing "
       "and same "
       "way, at 0.6 to 1.8 m/s, with centres that would pass at 0 to 0.6 m; steered, with "
       "body avoidance, for 9 s; contacts by triangles.",
       "no contacts (source: Throng; two people on free ground avoid each other)",
       encounters},
      {{"contacts"},
       {"Contact rate by density"},
       fmt::format("The bundled scenes {} for 20 s, four crowds each; contacts of two people by "
                   "triangles, density of people within 2 m. People who entered within the last "
                   "{} s do not count.",
                   fmt::join(kScenes, ", "), kExpected_s),
       fmt::format(
           "contacts per person-minute of all scenes together, at each level with 30 "
           "person-minutes: at most 1 per person and minute below 0.43 per m2, elsewhere at most "
           "1.5 times the recorded or 0.5 more; from {:g} per m2 on also at least 0.5 times the "
           "recorded; no fall from level to level beyond chance (95 %); at least three "
           "levels, one of them from {:g} per m2 on; source: {}",
           kTwoSidedFrom_per_m2, kTwoSidedFrom_per_m2, kRecordedContactsSource),
       contacts},
      {{"contacts_walked_again"},
       {"Contact rate on the recordings' ground"},
       "The setups of the three recordings, with their own inflow, for 90 s, six crowds each; "
       "measured as in contacts, all setups together, like the recordings.",
       fmt::format("as in contacts, and at every level from 0.43 per m2 on also at least 0.5 times "
                   "the recorded or 0.5 less; source: {}",
                   kRecordedContactsSource),
       contacts_walked_again}};
}

}  // namespace throng::validation
