// csv_export writes the messages of one channel of a log as comma-separated values. Rows are
// persons, events or frames, with the names and units of the messages. Joint positions are omitted.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lcm_io/export/exported_log.h"

namespace throng {

/// Names of the tables: "events", "states", "touching", "proximity", "contact_points",
/// "separation", "frame_stats".
const std::vector<std::string>& csv_channels();
/// Returns "events" for "THRONG_EVENTS" or "events"; "" for a channel without a table.
std::string csv_channel(std::string_view name);

/// Writes the text piece by piece and skips damage. Returns sentences on missing parts of the run,
/// or "".
std::string export_csv(ExportedLog& log, const std::string& channel,
                       const std::function<void(std::string_view text)>& write,
                       const std::function<bool()>& keep_going);

}  // namespace throng
