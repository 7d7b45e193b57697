// mcap_export writes a log as an MCAP file: part poses, meshes and contacts.
// Invariant: each begin and end of a contact is one message, so counts equal those of the log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "lcm_io/export/exported_log.h"

namespace throng {

struct McapExportOptions {
  double poses_hz = 10;  ///< rate in simulated time; states in between are omitted
};

struct McapExport {
  int64_t frames = 0;
  int64_t begins = 0, ends = 0;
  uint64_t bytes = 0;
  std::string missing;  ///< sentences on missing parts of the run, or ""
};

/// Calls `keep_going` repeatedly with the share of the log that was read. Skips damage. Throws
/// InputError for a log of several runs, EnvironmentError if writing fails; an existing file is
/// then unchanged.
McapExport export_mcap(ExportedLog& log, const std::filesystem::path& file,
                       const McapExportOptions& options,
                       const std::function<bool(double share)>& keep_going);

}  // namespace throng
