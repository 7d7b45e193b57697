#include "apps/recorded_frame.h"

#include <fmt/format.h>

#include "base/errors.h"

namespace throng {

RecordedFrame::RecordedFrame(const std::filesystem::path& log, int64_t number)
    : log_(log), reader_(log) {
  advance_to(number);
}

void RecordedFrame::advance_to(int64_t number) {
  LogEvent event;
  while (last_frame_ < number && reader_.next(event) == LogReader::Status::kEvent) {
    // The counters are the last message of a frame.
    if (run_.take(event.channel, event.data) == RunReader::Update::kCounters)
      last_frame_ = run_.counters()->frame;
  }
  if (run_.run() == nullptr)
    throw InputError(log_.string(), "a run's description", "none; is it a log of `throng run`?");
  if (last_frame_ < number || crowd().frame < 0)
    throw InputError(log_.string(), fmt::format("frame {}", number),
                     fmt::format("frames 0 to {}", last_frame_));
}

}  // namespace throng
