// RunRequest holds the options of a run in Python, by the names of run_options().
// Invariant: unknown names and invalid values are rejected before any file is read.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lcm_io/replay/run_source.h"

namespace throng {

struct RunRequest {
  std::string source;      ///< a file, or a bundled scene
  std::string scene_text;  ///< text of a scene file in place of `source`, which then is its name
  RunOptions options;
  SimulationOptions simulation;
  std::optional<double> trajectory_fps;
  bool trajectories = true;
  std::filesystem::path log, html, contacts, separation, trace_hash;
  std::vector<std::filesystem::path> trajectory;
  std::optional<int64_t> trajectory_piece;  ///< see TrajectoryOptions

  void forget_files() {
    for (std::filesystem::path* file : {&log, &html, &contacts, &separation, &trace_hash})
      file->clear();
    trajectory.clear();
  }
};

/// Converts a dictionary; None stands for an option not given. Requires the interpreter's lock.
/// Throws InputError, or Python's TypeError.
RunRequest request_of(const pybind11::dict& arguments);

/// Throws InputError.
RunSource open_source(const RunRequest& request);

/// Throws InputError naming `option` unless `value` is in [low, high], above low if `open`.
void require_number(const char* option, double value, double low, double high, bool open,
                    const std::string& what);

}  // namespace throng
