// EventHash hashes the contact events of a run: equal hashes mean equal events in equal frames.
// Invariant: events of a frame are added up in any order and grouping; frames are chained in order.
#pragma once

#include <cstdint>
#include <span>

#include "base/checksum.h"
#include "culling/pair.h"

namespace throng {

/// Content of the hash. The numbers are used in messages.
enum class EventHashKind : int32_t {
  kEvents = 1,          ///< pair and kind of the event
  kEventsAndLevels = 2  ///< also the refinement level, for runs with a budget
};

/// Sum of the events of a frame or of a part of them. Sums of parts add up to the sum of the frame.
struct EventSum {
  uint64_t count = 0;
  uint64_t sum = 0;  ///< modulo 2^64

  /// Different pairs or kinds, and different levels if these count, always add different numbers.
  void add(const PairEvent& event, EventHashKind kind) {
    const uint64_t level =
        kind == EventHashKind::kEventsAndLevels ? 1 + static_cast<uint64_t>(event.level) : 0;
    const uint64_t what = 1 + static_cast<uint64_t>(event.kind) + 2 * level;
    sum += mixed(event.pair.bits() + what * 0x9e3779b97f4a7c15ull);
    ++count;
  }
  void add(std::span<const PairEvent> events, EventHashKind kind) {
    for (const PairEvent& event : events) add(event, kind);
  }
  EventSum& operator+=(const EventSum& other) {
    count += other.count;
    sum += other.sum;
    return *this;
  }
};

/// Hash of all frames so far. 0 until the first event; a frame without events changes nothing.
class EventHash {
 public:
  EventHash() = default;
  /// Continues from a hash.
  explicit EventHash(uint64_t value) : value_(value) {}

  void add_frame(uint64_t frame, const EventSum& events) {
    if (events.count == 0) return;
    value_ = chained(chained(chained(value_, frame), events.count), events.sum);
  }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 0;
};

}  // namespace throng
