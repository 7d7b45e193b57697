// RunSource is the input of a run: a scene, a recording or a log, recognised by its content.
// Invariant: an option that does not apply to the kind is an InputError.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/run/run_options.h"

namespace throng {

struct RunSource {
  /// Motion other than a simulated crowd.
  struct Recording {
    RecordingFacts facts;
    int64_t people = 0;
  };

  Scene scene;
  MotionFactory motion = {};  ///< empty: the scene's crowd
  std::optional<Recording> recording = {};
  double scale_factor = 1;  ///< factor by which --avatars scaled the plan
  std::vector<std::string> notes = {};
};

/// Opens a file or bundled scene for a run. Throws InputError.
RunSource open_run_source(const std::string& name, const RunOptions& options);

/// Opens the text of a scene file for a run, see read_scene_text(). Throws InputError.
RunSource open_scene_text(const std::string& text, const std::string& name,
                          const RunOptions& options);

}  // namespace throng
