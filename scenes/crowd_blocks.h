// How the crowd is cut into blocks for the workers.
// One rule: blocks depend on the number of people only, never on the number of threads.
#pragma once

#include <algorithm>
#include <cstddef>

#include "scenes/crowd.h"

namespace throng {

/// A decision takes about a microsecond a person, a step a tenth: blocks of some ten microseconds.
inline constexpr size_t kPeopleABlock = 256;

inline int block_count(size_t people) {
  return static_cast<int>((people + kPeopleABlock - 1) / kPeopleABlock);
}

template <typename Body>
void Crowd::for_people(const Body& body) {
  const std::span<const uint32_t> order = grid_.order();
  workers_.for_blocks(block_count(order.size()), [&](int block, int) {
    const size_t begin = static_cast<size_t>(block) * kPeopleABlock;
    const size_t end = std::min(begin + kPeopleABlock, order.size());
    for (size_t slot = begin; slot < end; ++slot) body(order[slot]);
  });
}

/// The largest of body(id) over all people who are there; 0 if nobody is.
template <typename Body>
double Crowd::largest(const Body& body) {
  const std::span<const uint32_t> order = grid_.order();
  if (order.empty()) return 0;
  workers_.for_blocks(block_count(order.size()), [&](int block, int) {
    const size_t begin = static_cast<size_t>(block) * kPeopleABlock;
    const size_t end = std::min(begin + kPeopleABlock, order.size());
    double value = 0;
    for (size_t slot = begin; slot < end; ++slot) value = std::max(value, body(order[slot]));
    block_values_[static_cast<size_t>(block)] = value;
  });
  return *std::max_element(block_values_.begin(),
                           block_values_.begin() + block_count(order.size()));
}

}  // namespace throng
