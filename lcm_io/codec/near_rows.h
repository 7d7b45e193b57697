// Distances as rows of near_t, both ways.
// One rule: what is read is what was written, to the bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "culling/near.h"
#include "lcm_io/codec/channels.h"
#include "throng/near_t.hpp"

namespace throng {

/// Behind header, margins, hash and count.
inline constexpr size_t kNearPerMessage = (kMaxMessageBytes - kHeaderBytes - 20) / 88;

/// A message of the rows from number `first` on, as many as fit: those of parts, then those of two
/// people.
void set_near_chunk(near_t& m, const NearOptions& asked, uint64_t hash, const NearRows& parts,
                    const NearRows& people, size_t first);
/// Of a message that was checked.
NearPair near_at(const near_t& m, size_t i);

}  // namespace throng
