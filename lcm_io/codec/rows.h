// Conversion between message rows and pairs, events, distances, contact points and shortfalls.
// Invariant: reading returns the written values bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "culling/pair.h"
#include "culling/proximity.h"
#include "lcm_io/codec/channels.h"
#include "scenes/run/crowd_change.h"
#include "scenes/separation/separation_monitor.h"

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

/// Returns a pair of a message that passed validation.
template <class Message>
PairKey pair_at(const Message& m, size_t i) {
  return {static_cast<uint32_t>(m.a[i]), static_cast<uint32_t>(m.b[i]), m.part_a[i], m.part_b[i]};
}

/// Sets the events of a message; they must fit.
void set_events(events_t& m, std::span<const PairEvent> events);

/// Sets a message to the rows from number `first` on, as many as fit. Rows of parts come before
/// those of closest parts.
void set_proximity_chunk(proximity_t& m, const ProximityOptions& options, uint64_t hash,
                         const ProximityRows& parts, const ProximityRows& closest_parts,
                         size_t first);
ProximityPair proximity_at(const proximity_t& m, size_t i);

/// Sets the contact points of a message; they must fit.
void set_contacts(contact_points_t& m, std::span<const ContactPoint> rows);
ContactPoint contact_at(const contact_points_t& m, size_t i);

/// Maximum number of agents in a crowd_change_t with a goal of maximum length.
inline constexpr size_t kAgentsPerChange = 600;
/// Sets a message to a change of `count` agents from number `first` on.
void set_change(crowd_change_t& m, const CrowdChange& change, size_t first, size_t count);
/// Returns the change of a message that passed validation.
CrowdChange change_of(const crowd_change_t& m);

/// A begin or end of a shortfall; the last frame of an end is that of its message.
struct ShortfallEvent {
  EventKind kind = EventKind::kBegin;
  Shortfall shortfall;
};

void begin_separation(separation_t& m, size_t count);
void set_shortfall(separation_t& m, size_t i, EventKind kind, const Shortfall& shortfall);
ShortfallEvent shortfall_at(const separation_t& m, size_t i);

}  // namespace throng
