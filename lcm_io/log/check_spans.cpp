#include "lcm_io/log/check_spans.h"

#include <algorithm>

namespace throng {
namespace {

// 35 years in microseconds: longer than any run, and shorter than the time since 1970 of any clock.
constexpr int64_t kClock_us = int64_t{1} << 50;

}  // namespace

bool is_recorders_stamp(const MessageHeader& header, const LogEvent& event) {
  return event.stamp_us >= kClock_us && event.stamp_us - header.utime_us >= kClock_us / 2;
}

void LogHash::finish_frame() {
  for (KindHash& kind_hash : kind_hashes_) {
    is_chained_ = is_chained_ || kind_hash.frame.count > 0;
    kind_hash.hash.add_frame(static_cast<uint64_t>(frame_), kind_hash.frame);
    kind_hash.frame = {};
  }
}

void LogHash::add(int64_t frame, std::span<const PairEvent> events) {
  if (frame != frame_) finish_frame();
  frame_ = frame;
  for (const EventHashKind kind : {EventHashKind::kEvents, EventHashKind::kEventsAndLevels})
    kind_hash(kind).frame.add(events, kind);
}

void LogHash::start_from(uint64_t hash) {
  if (is_chained_) return;
  for (KindHash& kind_hash : kind_hashes_) kind_hash.hash = EventHash(hash);
}

uint64_t LogHash::value(EventHashKind kind) {
  finish_frame();
  return kind_hash(kind).hash.value();
}

void LogHash::resume_from(EventHashKind kind, uint64_t hash) {
  finish_frame();
  kind_hash(kind).hash = EventHash(hash);
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

bool CheckSpans::is_gap(const checksums_t& stated, const LogEvent& event,
                        const MessageHeader& header) const {
  return is_recorders_stamp(header, event) && stated.message_index != next_number_;
}

std::vector<DamagedSpan> CheckSpans::differences(const checksums_t& stated, const LogEvent& event,
                                                 const MessageHeader& header) const {
  std::vector<DamagedSpan> out;
  if (stated.checksum_kind != kChecksumKind || is_gap(stated, event, header)) return out;
  for (const Channel channel : kAllChannels) {
    const RunningChecksums::Sum written = sum_of(channel, stated), found = sums_[channel];
    const bool is_misnumbered = channel == Channel::kChecksums &&
                                !is_recorders_stamp(header, event) &&
                                stated.message_index != event.number;
    if (written == found && !is_misnumbered) continue;
    const int64_t before = at_last_[channel].messages;
    out.push_back({channel, last_frame_, stated.frame, last_byte_, event.offset,
                   written.messages - before, found.messages - before});
  }
  return out;
}

void CheckSpans::adopt(const checksums_t& stated, const LogEvent& event) {
  for (const Channel channel : kAllChannels) sums_[channel] = sum_of(channel, stated);
  at_last_ = sums_;
  next_number_ = stated.message_index;
  last_frame_ = stated.frame;
  last_byte_ = event.offset;
}

void CheckSpans::fill(checksums_t& stated, const LogEvent& event,
                      const MessageHeader& header) const {
  sums_.fill(stated);
  stated.message_index = is_recorders_stamp(header, event) ? next_number_ : event.number;
}

}  // namespace throng
