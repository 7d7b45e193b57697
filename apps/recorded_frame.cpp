#include "apps/recorded_frame.h"

#include <fmt/format.h>

#include "base/errors.h"
#include "lcmtypes/log_reader.h"

namespace throng {

RecordedFrame::RecordedFrame(const std::filesystem::path& log, int64_t number) {
  LogReader reader(log);
  LogEvent event;
  int64_t last_frame = -1;
  while (last_frame < number && reader.next(event) == LogReader::Status::kEvent) {
    // The counters are the last message of a frame.
    if (run_.take(event.channel, event.data) == RunReader::Update::kCounters)
      last_frame = run_.counters()->frame;
  }
  if (run_.run() == nullptr)
    throw InputError(log.string(), "a run's description", "none; is it a log of `throng run`?");
  if (last_frame < number || crowd().frame < 0)
    throw InputError(log.string(), fmt::format("frame {}", number),
                     fmt::format("frames 0 to {}", last_frame));
}

}  // namespace throng
