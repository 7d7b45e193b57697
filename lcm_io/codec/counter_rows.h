// What a frame's culling did and how long it took, as stages_t and counters_t.
// One rule: a log has no clock in it, so that it is the same every time.
#pragma once

#include <cstdint>

#include "scenes/run/sink.h"
#include "throng/counters_t.hpp"
#include "throng/stages_t.hpp"

namespace throng {

/// `clock`: with the times that were measured, else 0.
void fill_stages(stages_t& m, const Frame& frame, bool clock);
void fill_counters(counters_t& m, const Frame& frame, int64_t begins, bool clock);

}  // namespace throng
