// How the crowd is cut into blocks for the workers.
// One rule: blocks depend on the number of people only, never on the number of threads.
#pragma once

#include <algorithm>
#include <cstddef>

#include "scenes/crowd/crowd.h"

namespace throng {

/// A decision takes about half a microsecond a person, a step a tenth: blocks of some ten
/// microseconds.
inline constexpr size_t kPeopleABlock = 256;

inline int block_count(size_t people) {
  return static_cast<int>((people + kPeopleABlock - 1) / kPeopleABlock);
}

/// Everybody who is there, neighbours in space together.
template <typename Body>
void Crowd::for_slots(const Body& body) {
  const size_t slots = grid_.order().size();
  workers_.for_blocks(block_count(slots), [&](int block, int worker) {
    const size_t begin = static_cast<size_t>(block) * kPeopleABlock;
    body(begin, std::min(begin + kPeopleABlock, slots), worker);
  });
}

/// Those who decide now, neighbours in space together.
template <typename Body>
void Crowd::for_deciders(const Body& body) {
  const Slots all = deciders();
  workers_.for_blocks(block_count(all.size()), [&](int index, int worker) {
    const auto block = static_cast<size_t>(index);
    const size_t begin = block * kPeopleABlock;
    body(all.subspan(begin, std::min(kPeopleABlock, all.size() - begin)), block, worker);
  });
}

template <typename Body>
double Crowd::largest(const Body& body) {
  for_deciders([&](Slots slots, size_t block, int) { block_values_[block] = body(slots, block); });
  double value = 0;
  for (int block = 0; block < block_count(deciders().size()); ++block)
    value = std::max(value, block_values_[static_cast<size_t>(block)]);
  return value;
}

}  // namespace throng
