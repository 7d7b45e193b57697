// The options that a recording needs where its file does not say: the same for every command that
// reads one.
#pragma once

#include "apps/options/command_line.h"
#include "recordings/recording_flags.h"

namespace throng {

/// --fps, --unit, --heading-unit, --columns, --separator, --tracks, --strict.
void add_recording_options(CommandOptions& app, RecordingFlags& flags);

}  // namespace throng
