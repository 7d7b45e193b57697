// LogMotion replays a log as a motion source: its poses are culled again, with other options,
// without simulation.
// Invariant: position, posture and presence of all avatars are those of the log; its contacts are
// not read.
#pragma once

#include <filesystem>

#include "recordings/recording.h"
#include "scenes/run/simulation.h"

namespace throng {

struct LogRun {
  /// Name, seed, ground, obstacles, part volume and exactness of the run; step and duration of its
  /// states. No groups.
  Scene scene;
  MotionFactory motion;
  int64_t people = 0;
  /// Kind, rate, frames, duration and anomalies; the other facts concern recorded people only.
  RecordingFacts facts;
};

/// Reads a log from end to end; each motion source reads it again, frame by frame. Throws
/// InputError, one line naming the file, if the log cannot be culled.
LogRun read_log_run(const std::filesystem::path& file);

}  // namespace throng
