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

template <typename Body>
std::span<const double> Crowd::by_block(const Body& body) {
  for_slots([&](size_t begin, size_t end, int) {
    block_values_[begin / kPeopleABlock] = body(begin, end);
  });
  return {block_values_.data(), static_cast<size_t>(block_count(grid_.order().size()))};
}

template <typename Body>
double Crowd::largest(const Body& body) {
  double value = 0;
  for (const double each : by_block(body)) value = std::max(value, each);
  return value;
}

}  // namespace throng
