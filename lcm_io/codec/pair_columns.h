// The columns that name pairs of parts, in the messages that have some.
// One rule: the same in every type, so that one reader serves all; `level` where it may differ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "culling/pair.h"
#include "lcm_io/codec/channels.h"
#include "throng/events_t.hpp"

namespace throng {

template <class Message>
void resize_pairs(Message& m, size_t count) {
  m.count = static_cast<int32_t>(count);
  m.a.resize(count);
  m.b.resize(count);
  m.part_a.resize(count);
  m.part_b.resize(count);
  if constexpr (requires { m.level; }) m.level.resize(count);
}

template <class Message>
void set_pair(Message& m, size_t i, const PairKey& pair) {
  m.a[i] = static_cast<int32_t>(pair.a());
  m.b[i] = static_cast<int32_t>(pair.b());
  m.part_a[i] = static_cast<uint8_t>(pair.part_a());
  m.part_b[i] = static_cast<uint8_t>(pair.part_b());
}
template <class Message>
void set_pair(Message& m, size_t i, const PairKey& pair, uint8_t level) {
  set_pair(m, i, pair);
  m.level[i] = level;
}

/// Behind header and count.
inline constexpr size_t kEventsPerMessage = (kMaxMessageBytes - kHeaderBytes - 4) / 12;

/// A message of these events, no more than fit.
inline void set_events(events_t& m, std::span<const PairEvent> events) {
  resize_pairs(m, events.size());
  m.kind.resize(events.size());
  for (size_t i = 0; i < events.size(); ++i) {
    set_pair(m, i, events[i].pair, static_cast<uint8_t>(events[i].level));
    m.kind[i] = static_cast<uint8_t>(events[i].kind);
  }
}

/// Of a message that was checked.
template <class Message>
PairKey pair_at(const Message& m, size_t i) {
  return {static_cast<uint32_t>(m.a[i]), static_cast<uint32_t>(m.b[i]), m.part_a[i], m.part_b[i]};
}

}  // namespace throng
