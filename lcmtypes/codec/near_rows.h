// Distances as rows of near_t, both ways.
// One rule: what is read is what was written, to the bit.
#pragma once

#include <cstddef>
#include <cstdint>

#include "culling/near.h"
#include "throng/near_t.hpp"

namespace throng {

/// A message of so many rows, to be set.
void begin_near(near_t& m, const NearOptions& asked, uint64_t hash, size_t count);
/// `of_people`: the nearest parts of two people, not a pair within near_m.
void set_near(near_t& m, size_t i, const NearPair& row, bool of_people);
/// Of a message that was checked.
NearPair near_at(const near_t& m, size_t i);

}  // namespace throng
