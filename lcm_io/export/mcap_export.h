// A log as an MCAP file: where every part is, the bodies' meshes, and what touches.
// One rule: every begin and every end of a contact is one message, so that counts are the log's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "lcm_io/export/exported_log.h"

namespace throng {

struct McapExportOptions {
  double poses_hz = 10;  ///< of simulated time; states that lie nearer together are left out
};

struct McapExport {
  int64_t frames = 0;  ///< of which there are poses
  int64_t begins = 0, ends = 0;
  uint64_t bytes = 0;
  std::string missing;  ///< what of the run the log lacks, in sentences, or ""
};

/// `keep_going` is asked now and then with the share of the log that was read. Damage is skipped.
/// Throws InputError if the log is of several runs, EnvironmentError if nothing can be written; an
/// older file is then as it was.
McapExport export_mcap(ExportedLog& log, const std::filesystem::path& file,
                       const McapExportOptions& options,
                       const std::function<bool(double share)>& keep_going);

}  // namespace throng
