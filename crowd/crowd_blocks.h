// How the crowd is cut into blocks for the workers.
// One rule: blocks depend on the number of people only, never on the number of threads.
#pragma once

#include <algorithm>
#include <cstddef>

#include "crowd/crowd.h"

namespace throng {

/// A decision takes about half a microsecond a person, a step a tenth: blocks of some ten
/// microseconds.
inline constexpr size_t kPeopleABlock = 256;

inline int block_count(size_t people) {
  return static_cast<int>((people + kPeopleABlock - 1) / kPeopleABlock);
}

/// Calls body(begin, end, worker) for the blocks of so many people.
template <typename Body>
void for_people(Workers& workers, size_t people, const Body& body) {
  workers.for_blocks(block_count(people), [&](int block, int worker) {
    const size_t begin = static_cast<size_t>(block) * kPeopleABlock;
    body(begin, std::min(begin + kPeopleABlock, people), worker);
  });
}

/// Everybody who is there, neighbours in space together.
template <typename Body>
void Crowd::for_slots(const Body& body) {
  for_people(workers_, grid_.order().size(), body);
}

/// Those who decide now, neighbours in space together.
template <typename Body>
void Crowd::for_deciders(const Body& body) {
  const Slots all = deciders();
  for_people(workers_, all.size(), [&](size_t begin, size_t end, int worker) {
    body(all.subspan(begin, end - begin), begin / kPeopleABlock, worker);
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
