// RunRequest holds what is asked of a run in Python: the rows of run_options(), by their names.
// One rule: a name that does not exist and a value that cannot be are refused before anything is
// read.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lcm_io/replay/run_source.h"

namespace throng {

struct RunRequest {
  std::string source;  ///< a file, or a bundled scene
  RunOptions options;
  SimulationOptions simulation;  ///< what `options` ask for
  // What is kept, and what is written.
  std::optional<double> trajectory_fps;
  bool trajectories = true;
  std::filesystem::path log, html, contacts, separation, trace_hash;
  std::vector<std::filesystem::path> trajectory;
  std::optional<int64_t> trajectory_piece;  ///< see TrajectoryOptions
};

/// Of a dictionary whose values are None where they were not given. With the interpreter's lock
/// held. Throws InputError, or TypeError of Python.
RunRequest request_of(const pybind11::dict& arguments);

/// Throws InputError naming `option` unless `value` is a number in [low, high], above low if
/// `open`.
void require_number(const char* option, double value, double low, double high, bool open,
                    const std::string& what);

}  // namespace throng
