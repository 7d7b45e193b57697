// How bodies touch whom steering brings together: two alone, and crowds.
#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "analysis/validation/behaviour.h"
#include "analysis/validation/recorded_inflow.h"
#include "scenes/retargeting/tracks.h"

namespace throng::validation {
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
  return judged({}, judge_encounters(meet(kEncounters, conditions)));
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
