// What a command runs: a scene, a recording or a log, whichever the file is.
// One rule: the kind is known by content; an option that a kind has no use for is refused, never
// left aside.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/options/recording_options.h"
#include "apps/output/run_report.h"
#include "scenes/run/simulation.h"

namespace throng {

class OutputPlan;

struct RunSourceOptions {
  std::string name;  ///< a file, or a bundled scene
  std::optional<int> avatars;
  std::optional<double> seconds;
  std::optional<uint64_t> seed;
  std::string steering;
  std::string part_volume;
  bool exact = false;
  RecordingFlags recording;
  std::string step;  ///< of a recording: "smooth" or "recorded"
};

/// FILE, --avatars, --seconds, --seed, --steering, --part-volume, --exact, and what recordings
/// need.
void add_run_source_options(CommandOptions& app, RunSourceOptions& options);

struct RunSource {
  Scene scene;
  WorldFactory world = {};  ///< empty: the scene's own
  std::optional<RunReport::Recording> recording = {};
  double plan_factor = 1;  ///< how many times longer --avatars made the plan
  std::vector<std::string> notes = {};
};

/// Reads what is to be run. Throws InputError.
RunSource open_run_source(const RunSourceOptions& options);

/// The files that it was read from.
void plan_inputs(const Scene& scene, OutputPlan& plan);

}  // namespace throng
