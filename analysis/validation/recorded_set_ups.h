// The six set-ups in which people's speed against density was recorded, as scenes.
// One rule: geometry and free speeds are the experiments'; how people steer is what everybody gets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/validation/area_speeds.h"
#include "analysis/validation/set_ups.h"

namespace throng::validation {

/// One run of a set-up: so many people, or entrances and an exit so wide.
struct RecordedRun {
  Plan plan;
  std::vector<Rectangle> areas;    ///< measured, each for itself
  std::vector<Rectangle> waiting;  ///< measured as long as somebody stands here
  std::optional<Oval> oval;        ///< of people who go round; nobody waits
  double end_s = 0;
};

/// Runs of `single_file`, `ug`, `uo`, `eo`, `ko` or `bot`, from the emptiest to the fullest or so,
/// and where one says little all of them again with other people.
int recorded_runs(const std::string& id);
RecordedRun recorded_run(const std::string& id, int run, const Conditions& conditions);

/// What the run's areas are like, twice a second, once people have spread.
std::vector<DensitySpeed> speeds_of(const RecordedRun& run, const std::string& id,
                                    Outcome& outcome);

}  // namespace throng::validation
