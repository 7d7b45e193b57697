// What somebody says about a recording in words, where its file does not: the same words wherever
// one is read. One rule: they are given for recordings only; whoever is handed something else
// refuses them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recordings/recording.h"

namespace throng {

struct RecordingFlags {
  std::optional<double> fps;
  std::string unit;          ///< one of unit_names()
  std::string heading_unit;  ///< one of heading_unit_names()
  std::string columns;       ///< "id=pedID,t=time,x=posX,y=posY"
  std::string separator;     ///< see separator_named()
  std::string tracks;        ///< one of tracks_names()
  bool strict = false;
};

std::vector<std::string> unit_names();
std::vector<std::string> heading_unit_names();
std::vector<std::string> tracks_names();
/// One character, or that of tab, blank, comma or semicolon; of anything else 0.
char separator_named(const std::string& name);

RecordingOptions recording_options(const std::filesystem::path& file, const RecordingFlags& flags);

}  // namespace throng
