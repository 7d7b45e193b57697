// The options that a recording needs where its file does not say: the same for every command that
// reads one.
// One rule: they are given for recordings only; whoever is handed something else refuses them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/options/command_line.h"
#include "scenes/recorded/recording.h"

namespace throng {

struct RecordingFlags {
  std::optional<double> fps;
  std::string unit;       ///< "cm"
  std::string columns;    ///< "id=pedID,t=time,x=posX,y=posY"
  std::string separator;  ///< one character, or tab, blank, comma, semicolon
  std::string tracks;     ///< head or centre
  bool strict = false;

  /// The first option that was given, "--fps", or "".
  std::string given() const;
};

/// --fps, --unit, --columns, --separator, --tracks, --strict.
void add_recording_options(CommandOptions& app, RecordingFlags& flags);

RecordingOptions recording_options(const std::filesystem::path& file, const RecordingFlags& flags);

/// Throws InputError if any was given: `what` ("a scene") needs none.
void require_no_recording_options(const RecordingFlags& flags, const std::string& what);

}  // namespace throng
