// The hash of a run's events: equal hashes, equal begins and ends in equal frames.
// One rule: a frame's events are added up, so that the parts of a crowd, wherever they are held,
// can be summed apart and added; the frames' sums are then chained in their order.
#pragma once

#include <cstdint>
#include <span>

#include "base/checksum.h"
#include "culling/pair.h"

namespace throng {

/// What the hash says of each event. The numbers go into messages.
enum class EventHashKind : int32_t {
  kEvents = 1,          ///< the pair and whether it began or ended
  kEventsAndLevels = 2  ///< how far it was refined, too: under a deadline
};

/// Of the events of a frame, or of any part of them: sums of parts add up to the sum of the whole.
struct EventSum {
  uint64_t count = 0;
  uint64_t sum = 0;  ///< modulo 2^64

  /// Another pair or kind is certain to add another number, and another level where levels count.
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

/// Over the frames so far. 0 until something happens; a frame without events changes nothing.
class EventHash {
 public:
  EventHash() = default;
  /// Goes on behind a hash.
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
