// SortedRuns sorts the results of tasks for pairs of bodies: a counting sort by body a, then each
// body's few by body b.
// Invariant: runs refer to the tasks' memory, which must stay valid until they are read.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "base/counting_sort.h"
#include "base/memory.h"
#include "base/workers.h"

namespace throng {

template <typename Item>
class SortedRuns {
 public:
  struct Run {
    uint32_t body_b, count;
    const Item* items;
  };
  struct BodyRun {
    uint32_t body_a;
    Run run;
  };

  /// each(visit) calls visit(BodyRun) for every run, at most one per pair of bodies, repeatably.
  template <typename Each>
  void sort(size_t bodies, Workers& workers, const Each& each);

  size_t block_count() const { return (bodies_ + kBlock - 1) / kBlock; }
  size_t first_body(size_t block) const { return block * kBlock; }
  size_t end_body(size_t block) const { return std::min(bodies_, (block + 1) * kBlock); }
  /// Items of all blocks before `block`; all items for block_count().
  uint32_t items_before(size_t block) const { return items_before_[block]; }
  size_t item_count() const { return bodies_ == 0 ? 0 : items_before_[block_count()]; }
  /// Calls visit(body a, run) for the runs of a block, in order.
  template <typename Visit>
  void for_runs(size_t block, const Visit& visit) const {
    const uint32_t end = start_of_body_[end_body(block)];
    for (size_t body = first_body(block); body < end_body(block); ++body) {
      for (uint32_t r = start_of_body_[body]; r < start_of_body_[body + 1]; ++r) {
        // Items are in the memory of their tasks, in no order that a cache could predict.
        if (r + kRunsAhead < end) __builtin_prefetch(runs_[r + kRunsAhead].items);
        visit(body, runs_[r]);
      }
    }
  }

  uint64_t times_grown() const {
    return uint64_t{runs_.times_grown()} + start_of_body_.times_grown() +
           items_before_.times_grown();
  }

 private:
  static constexpr size_t kBlock = 1024;
  static constexpr uint32_t kRunsAhead = 8;

  size_t bodies_ = 0;
  GrowBuffer<Run> runs_;
  GrowBuffer<uint32_t> start_of_body_, items_before_;
};

template <typename Item>
template <typename Each>
void SortedRuns<Item>::sort(size_t bodies, Workers& workers, const Each& each) {
  bodies_ = bodies;
  size_t count = 0;
  each([&](const BodyRun&) { ++count; });
  runs_.resize(count);
  start_of_body_.resize(bodies + 2);
  counting_sort(
      bodies, start_of_body_.data(), each, [](const BodyRun& found) { return found.body_a; },
      [&](const BodyRun& found, uint32_t at) { runs_[at] = found.run; });
  items_before_.resize(block_count() + 1);
  workers.for_blocks(static_cast<int>(block_count()), [&](int index, int) {
    const auto block = static_cast<size_t>(index);
    uint32_t items = 0;
    for (size_t body = first_body(block); body < end_body(block); ++body) {
      Run* const first = runs_.data() + start_of_body_[body];
      Run* const last = runs_.data() + start_of_body_[body + 1];
      std::sort(first, last, [](const Run& p, const Run& q) { return p.body_b < q.body_b; });
      for (const Run* run = first; run != last; ++run) items += run->count;
    }
    items_before_[block + 1] = items;
  });
  items_before_[0] = 0;
  for (size_t block = 0; block < block_count(); ++block)
    items_before_[block + 1] += items_before_[block];
}

}  // namespace throng
