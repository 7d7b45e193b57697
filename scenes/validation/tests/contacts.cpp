// How bodies touch whom steering brings together: two alone, and crowds.
#include <fmt/format.h>

#include <utility>

#include "scenes/validation/behaviour.h"
#include "scenes/validation/recorded_inflow.h"

namespace throng::validation {
namespace {

constexpr uint64_t kEncounters = 1000;
constexpr double kScene_s = 20;
/// One crowd's contacts differ from another's by a tenth.
constexpr uint64_t kSceneCrowds = 3;
/// Through the corridor and the door people are within a minute and a half. So many crowds spend
/// half an hour at all levels but the lowest.
constexpr double kWalkedAgain_s = 90;
constexpr uint64_t kContactCrowds = 6;

Outcome encounters(const Conditions& conditions) {
  return judged({}, judge_encounters(meet(kEncounters, conditions)));
}

void add(const std::vector<LevelContacts>& more, std::vector<LevelContacts>& levels) {
  levels.resize(more.size());
  for (size_t i = 0; i < more.size(); ++i) {
    levels[i].contacts += more[i].contacts;
    levels[i].person_s += more[i].person_s;
  }
}

Outcome contacts(const Conditions& conditions) {
  std::vector<LevelContacts> levels;
  for (uint64_t crowd = 0; crowd < kSceneCrowds; ++crowd)
    for (const char* name : {"plaza", "corridor", "crossing", "rush_hour"})
      add(contacts_of(bundled_plan(name, conditions.of_run(crowd, kSceneCrowds)), kScene_s),
          levels);
  return judged({}, judge_contacts(levels));
}

/// Density alone does not tell how often people touch: here it is the recordings' own geometry and
/// inflow.
Outcome contacts_walked_again(const Conditions& conditions) {
  Outcome outcome;
  std::vector<LevelContacts> levels;
  for (const char* id : {"spacing_corridor", "spacing_door"}) {
    const auto recording = recording_of(inflow_site(id, conditions), conditions, outcome);
    if (recording == nullptr) return outcome;
    for (uint64_t crowd = 0; crowd < kContactCrowds; ++crowd) {
      const InflowSite site = inflow_site(id, conditions.of_run(crowd, kContactCrowds));
      add(contacts_of(with_inflow(site, *recording), kWalkedAgain_s), levels);
    }
  }
  return judged(std::move(outcome), judge_contacts(levels));
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
       "The bundled scenes plaza, corridor, crossing and rush_hour for 20 s, three crowds each; "
       "contacts of two people by triangles, by the people within 2 m.",
       fmt::format("levels with 30 person-minutes, three of them at least: at most 1 a person and "
                   "minute below 0.43 per m2, elsewhere 0.5 to 1.5 times the recorded or within "
                   "0.5 of it, not falling from level to level by more than chance (95 %); source: "
                   "{}",
                   kRecordedContactsSource),
       contacts},
      {{"contacts_walked_again"},
       {"How often people touch where recorded people did"},
       "The set-ups of spacing_corridor and spacing_door, with the recordings' own inflow, for "
       "90 s, six crowds each; contacts of two people by triangles, by the people within 2 m.",
       fmt::format("as for contacts; source: {}", kRecordedContactsSource),
       contacts_walked_again}};
}

}  // namespace throng::validation
