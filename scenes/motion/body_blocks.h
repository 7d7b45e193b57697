// Body blocks divide the avatars of a run among the workers.
// Invariant: a block holds avatars of one model; blocks do not depend on the number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

struct BodyBlock {
  uint32_t first = 0;
  uint32_t count = 0;
};

/// Avatars per block: a posture row takes about 50 ns, a state less.
inline constexpr uint32_t kBodiesPerBlock = 256;

inline std::vector<BodyBlock> blocks_of(std::span<const uint16_t> types, uint32_t first = 0) {
  std::vector<BodyBlock> blocks;
  for (uint32_t id = first; id < types.size(); ++id) {
    const bool continues = !blocks.empty() && blocks.back().count < kBodiesPerBlock &&
                           types[blocks.back().first] == types[id];
    if (!continues) blocks.push_back({id, 0});
    ++blocks.back().count;
  }
  return blocks;
}

}  // namespace throng
