// Arguments of a command line that are rows of run_options().
#pragma once

#include <functional>

#include "apps/options/command_line.h"
#include "scenes/run/run_options.h"

namespace throng {

/// FILE, what is run, and every row.
void add_run_options(CommandOptions& app, std::string& file, RunOptions& options);
/// The row of that name alone.
void add_run_option(CommandOptions& app, const std::string& name, RunOptions& options);
/// What a recording needs where its file does not say: --fps, --unit, ...
void add_recording_options(CommandOptions& app, RunOptions& options);

}  // namespace throng
