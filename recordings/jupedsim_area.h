// JuPedSim's databases state the walkable area in addition to the trajectories.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/files/regular_file.h"

namespace throng {

struct StatedArea {
  std::string wkt;    ///< area in the first frame; empty: the database has none
  int64_t areas = 0;  ///< number of different areas during the recording
  std::string unit;   ///< empty: not stated
};

/// Whether a file with this beginning is a database of SQLite.
bool is_sqlite(std::string_view head);

/// Reads the area without the trajectories, from a database of JuPedSim or Throng. Throws
/// ParseFailure; runs in the child of a sandbox.
StatedArea parse_stated_area(const RegularFile& file);

/// Throws InputError for a database with a journal: the database lacks its changes.
void reject_unfinished_database(const std::filesystem::path& file);

}  // namespace throng
