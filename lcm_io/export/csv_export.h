// The messages of a channel of a log as comma-separated values.
// One rule: a row a person, an event or a frame, names and units as in the messages; nothing is
// left out but the joints of states.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lcm_io/export/exported_log.h"

namespace throng {

/// "events", "states", "touching", "near", "contacts", "separation", "frame_stats".
const std::vector<std::string>& csv_channels();
/// "THRONG_EVENTS" is "events"; "" for what has no such table.
std::string csv_channel(std::string_view name);

/// Gives the text piece by piece; damage is skipped. Returns what of the run the log lacks, in
/// sentences, or "".
std::string export_csv(ExportedLog& log, const std::string& channel,
                       const std::function<void(std::string_view text)>& write,
                       const std::function<bool()>& keep_going);

}  // namespace throng
