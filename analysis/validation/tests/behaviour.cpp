// How people move and stand: accelerations, queues, audiences, crowds that stand close.
#include "analysis/validation/behaviour.h"

#include <utility>

#include "analysis/validation/recorded_set_ups.h"
#include "analysis/validation/recorded_situations.h"

namespace throng::validation {
namespace {

constexpr double kSeconds = 20;
constexpr double kSetUpSeconds = 60;

Outcome accelerations(const Conditions& conditions) {
  Outcome outcome;
  std::vector<Accelerated> all;
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
  std::vector<Queued> all;
  all.push_back(queue_in("bottleneck", bundled_plan("bottleneck", conditions),
                         {{-12.2, -5.2}, {0, 5.2}}, 60, outcome));
  all.push_back(queue_in("door of 0.9 m",
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
  std::vector<Standing> all;
  for (const double per_m2 : {0.5, 2.0, 4.0, 6.0})
    all.push_back(stand_close(per_m2, conditions, outcome));
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

}  // namespace throng::validation
