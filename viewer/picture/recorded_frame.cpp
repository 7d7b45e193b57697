#include "viewer/picture/recorded_frame.h"

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
  if (last_frame_ < number)
    throw InputError(log_.string(), fmt::format("frame {}", number),
                     fmt::format("frames 0 to {}", last_frame_));
  if (crowd().frame < 0) {
    const std::optional<int64_t> first = next_states();
    throw InputError(log_.string(), fmt::format("states at or before frame {}", number),
                     first ? fmt::format("the first at frame {}", *first) : "none");
  }
}

std::optional<int64_t> RecordedFrame::next_states() {
  LogEvent event;
  MessageHeader header;
  while (reader_.next(event) == LogReader::Status::kEvent)
    if (event.channel == name_of(Channel::kStates) &&
        read_header(Channel::kStates, event.data, header).empty() && header.frame > last_frame_)
      return header.frame;
  return std::nullopt;
}

}  // namespace throng
