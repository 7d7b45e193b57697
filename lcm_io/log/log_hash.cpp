#include "lcm_io/log/log_hash.h"

namespace throng {
namespace {

size_t way_of(EventHashKind kind) { return kind == EventHashKind::kEventsAndLevels ? 1 : 0; }

}  // namespace

bool LogHash::is_known(int32_t kind) {
  return kind == static_cast<int32_t>(EventHashKind::kEvents) ||
         kind == static_cast<int32_t>(EventHashKind::kEventsAndLevels);
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
  is_empty_ = is_empty_ && events.empty();
  for (const PairEvent& event : events) {
    ways_[0].frame.add(event, EventHashKind::kEvents);
    ways_[1].frame.add(event, EventHashKind::kEventsAndLevels);
    for (Way& way : ways_)
      for (const uint64_t word :
           {static_cast<uint64_t>(frame), event.pair.bits(), static_cast<uint64_t>(event.kind)})
        way.old_hash = (way.old_hash ^ word) * 0x100000001b3ull;
    ways_[1].old_hash = (ways_[1].old_hash ^ static_cast<uint64_t>(event.level)) * 0x100000001b3ull;
  }
}

void LogHash::start_from(uint64_t hash) {
  if (is_chained_) return;
  for (Way& way : ways_) way.hash = EventHash(hash);
}

uint64_t LogHash::value(EventHashKind kind) {
  finish_frame();
  return ways_[way_of(kind)].hash.value();
}

void LogHash::go_on_from(EventHashKind kind, uint64_t hash) {
  finish_frame();
  ways_[way_of(kind)].hash = EventHash(hash);
  is_chained_ = true;
}

bool LogHash::is_old_hash(uint64_t hash) const {
  // Without culling there was none.
  return hash == ways_[0].old_hash || hash == ways_[1].old_hash || (hash == 0 && is_empty_);
}

}  // namespace throng
