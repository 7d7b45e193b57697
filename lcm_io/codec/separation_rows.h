// Shortfalls of separation as rows of separation_t, both ways.
// One rule: what is read is what was written, to the bit.
#pragma once

#include <cstddef>

#include "culling/pair.h"
#include "scenes/separation/separation_monitor.h"
#include "throng/separation_t.hpp"

namespace throng {

/// A begin or an end; an end's last frame is that of its message.
struct ShortfallEvent {
  EventKind kind = EventKind::kBegin;
  Shortfall shortfall;
};

/// A message of so many rows, to be set.
void begin_separation(separation_t& m, size_t count);
void set_shortfall(separation_t& m, size_t i, EventKind kind, const Shortfall& shortfall);
/// Of a message that was checked.
ShortfallEvent shortfall_at(const separation_t& m, size_t i);

}  // namespace throng
