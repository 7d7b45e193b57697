// What is run: a scene, a recording or a log, whichever the file is.
// One rule: the kind is known by content; an option that a kind has no use for is refused, never
// left aside.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/run/run_options.h"

namespace throng {

struct RunSource {
  /// What is culled instead of a crowd of our own.
  struct Recording {
    RecordingFacts facts;
    int64_t people = 0;
  };

  Scene scene;
  MotionFactory motion = {};  ///< empty: the scene's own
  std::optional<Recording> recording = {};
  double scale_factor = 1;  ///< how many times longer --avatars made the plan
  std::vector<std::string> notes = {};
};

/// Reads what is to be run: `name` is a file, or a bundled scene. Throws InputError.
RunSource open_run_source(const std::string& name, const RunOptions& options);

}  // namespace throng
