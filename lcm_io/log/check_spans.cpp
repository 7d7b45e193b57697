#include "lcm_io/log/check_spans.h"

#include <algorithm>

namespace throng {
namespace {

// 35 years of microseconds: no run is as long, and every clock is further from 1970.
constexpr int64_t kClock_us = int64_t{1} << 50;

}  // namespace

bool is_recorders_stamp(const MessageHeader& header, const LogEvent& event) {
  return event.stamp_us >= kClock_us && event.stamp_us - header.utime_us >= kClock_us / 2;
}

void LogHash::finish_frame() {
  for (Way& way : ways_) {
    is_chained_ = is_chained_ || way.frame.count > 0;
    way.hash.add_frame(static_cast<uint64_t>(frame_), way.frame);
    way.frame = {};
  }
}

void LogHash::add(int64_t frame, std::span<const PairEvent> events) {
  if (frame != frame_) finish_frame();
  frame_ = frame;
  for (const EventHashKind kind : {EventHashKind::kEvents, EventHashKind::kEventsAndLevels})
    way(kind).frame.add(events, kind);
}

void LogHash::start_from(uint64_t hash) {
  if (is_chained_) return;
  for (Way& way : ways_) way.hash = EventHash(hash);
}

uint64_t LogHash::value(EventHashKind kind) {
  finish_frame();
  return way(kind).hash.value();
}

void LogHash::go_on_from(EventHashKind kind, uint64_t hash) {
  finish_frame();
  way(kind).hash = EventHash(hash);
  is_chained_ = true;
}

void CheckSpans::add(Channel channel, const LogEvent& event, const MessageHeader* header) {
  if (header == nullptr || !is_recorders_stamp(*header, event)) {
    sums_.add(channel, event.number, event.stamp_us, event.data);
    next_number_ = event.number < INT64_MAX ? event.number + 1 : 0;
    return;
  }
  const std::pair run(header->run_id, header->instance);
  if (!recorded_) recorded_ = run;
  if (*recorded_ != run) return;
  sums_.add(channel, next_number_++, header->utime_us, event.data);
}

bool CheckSpans::is_gap(const checks_t& said, const LogEvent& event,
                        const MessageHeader& header) const {
  return is_recorders_stamp(header, event) && said.number != next_number_;
}

std::vector<DamagedSpan> CheckSpans::differences(const checks_t& said, const LogEvent& event,
                                                 const MessageHeader& header) const {
  std::vector<DamagedSpan> out;
  if (said.check_kind != kCheckKind || is_gap(said, event, header)) return out;
  for (const Channel channel : kAllChannels) {
    const RunningChecks::Sum written = sum_of(channel, said), found = sums_[channel];
    const bool is_misnumbered = channel == Channel::kChecks && !is_recorders_stamp(header, event) &&
                                said.number != event.number;
    if (written == found && !is_misnumbered) continue;
    const int64_t before = at_last_[channel].messages;
    out.push_back({channel, last_frame_, said.frame, last_byte_, event.offset,
                   written.messages - before, found.messages - before});
  }
  return out;
}

void CheckSpans::adopt(const checks_t& said, const LogEvent& event) {
  for (const Channel channel : kAllChannels) sums_[channel] = sum_of(channel, said);
  at_last_ = sums_;
  next_number_ = said.number;
  last_frame_ = said.frame;
  last_byte_ = event.offset;
}

void CheckSpans::fill(checks_t& said, const LogEvent& event, const MessageHeader& header) const {
  sums_.fill(said);
  said.number = is_recorders_stamp(header, event) ? next_number_ : event.number;
}

}  // namespace throng
