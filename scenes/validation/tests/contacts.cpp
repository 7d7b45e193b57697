// How bodies touch whom steering brings together: two alone, and crowds.
#include <fmt/format.h>

#include <utility>

#include "scenes/validation/behaviour.h"

namespace throng::validation {
namespace {

constexpr uint64_t kEncounters = 1000;
constexpr double kEncounter_s = 20;

Outcome encounters(const Conditions& conditions) {
  return judged({}, judge_encounters(meet(kEncounters, conditions)));
}

Outcome contacts(const Conditions& conditions) {
  std::vector<LevelContacts> levels;
  for (const char* name : {"plaza", "corridor", "crossing", "rush_hour"}) {
    const std::vector<LevelContacts> more = contacts_of(name, kEncounter_s, conditions);
    levels.resize(more.size());
    for (size_t i = 0; i < more.size(); ++i) {
      levels[i].contacts += more[i].contacts;
      levels[i].person_s += more[i].person_s;
    }
  }
  return judged({}, judge_contacts(levels));
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
       "The bundled scenes plaza, corridor, crossing and rush_hour for 20 s; contacts of two "
       "people "
       "by triangles, by the people within 2 m.",
       fmt::format("levels with 30 person-minutes, three of them at least: at most 1 a person and "
                   "minute below 0.43 per m2, elsewhere 0.5 to 1.5 times the recorded or within "
                   "0.5 of it, not falling from level to level by more than chance (95 %); source: "
                   "{}",
                   kRecordedContactsSource),
       contacts}};
}

}  // namespace throng::validation
