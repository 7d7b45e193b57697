// Functions that add rows of run_options() to a command as arguments.
#pragma once

#include <functional>

#include "apps/options/command_line.h"
#include "scenes/run/run_options.h"

namespace throng {

/// Adds FILE and every row.
void add_run_options(CommandOptions& app, std::string& file, RunOptions& options);
/// Adds the row of that name.
void add_run_option(CommandOptions& app, const std::string& name, RunOptions& options);
/// Adds the options of recordings: --fps, --unit, ...
void add_recording_options(CommandOptions& app, RunOptions& options);

}  // namespace throng
