// What is run: a scene, a recording or a log, whichever the file is.
// One rule: the kind is known by content; an option that a kind has no use for is refused, never
// left aside.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recordings/recording_flags.h"
#include "scenes/run/simulation.h"

namespace throng {

struct RunSourceOptions {
  std::string name;  ///< a file, or a bundled scene
  std::optional<int> avatars;
  std::optional<double> seconds;
  std::optional<uint64_t> seed;
  std::string steering;
  std::string part_volume;  ///< see part_volumes_of()
  bool exact = false;
  std::optional<double> near_m, person_near_m;
  bool contact_points = false;
  std::string between, parts;  ///< see pair_rules_of()
  RecordingFlags recording;
  std::string step;  ///< of a recording: "smooth" or "recorded"
};

/// What --step takes.
std::vector<std::string> step_names();

struct RunSource {
  /// What is culled instead of a crowd of our own.
  struct Recording {
    RecordingFacts facts;
    int64_t people = 0;
  };

  Scene scene;
  WorldFactory world = {};  ///< empty: the scene's own
  std::optional<Recording> recording = {};
  double plan_factor = 1;  ///< how many times longer --avatars made the plan
  std::vector<std::string> notes = {};
};

/// Reads what is to be run. Throws InputError.
RunSource open_run_source(const RunSourceOptions& options);

}  // namespace throng
