// A log as a recording: its poses are culled again, with other options, without simulating.
// One rule: whoever is in the log is as the log has it: place, posture, presence. What the log says
// of contacts is not looked at.
#pragma once

#include <filesystem>

#include "recordings/recording.h"
#include "scenes/run/simulation.h"

namespace throng {

/// What a log gives to run.
struct LogRun {
  /// Name, seed, ground, obstacles, part volume and exactness of its run; step and duration of its
  /// states. No groups.
  Scene scene;
  MotionFactory motion;
  int64_t people = 0;
  /// Kind, rate, frames, duration, oddities; all else is of people alone.
  RecordingFacts facts;
};

/// Reads a log from end to end; each world then reads it again, frame by frame. Throws InputError,
/// one line that names the file, if nothing in it can be culled.
LogRun read_log_run(const std::filesystem::path& file);

}  // namespace throng
