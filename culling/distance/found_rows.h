// Rows that tasks find, pair of bodies by pair of bodies, and all of them in the order of their
// keys. One rule: what a task has found stays where it is until the rows have been taken.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/grow_buffer.h"
#include "base/workers.h"
#include "culling/event_hash.h"
#include "culling/kernels/kernels.h"
#include "culling/stages/sorted_runs.h"

namespace throng {

/// What one task finds.
template <typename Item>
class FoundRows {
 public:
  /// Those of two bodies.
  struct Run {
    uint32_t body_a, body_b, first, count;
  };

  void clear() { item_count_ = run_count_ = open_ = 0; }
  void add(const Item& item) {
    items_.grow(item_count_ + 1, item_count_);
    items_[item_count_++] = item;
  }
  /// What was added since the last run ended; to be sorted by key.
  std::span<Item> open() { return {items_.data() + open_, item_count_ - open_}; }
  /// Room for more, to be written from the end of open() on; `count` of them are then added.
  Item* room(size_t more) {
    items_.grow(item_count_ + more, item_count_);
    return items_.data() + item_count_;
  }
  void added(size_t count) { item_count_ += count; }
  /// open() are the rows of these two.
  void end_run(const BodyPair& bodies) {
    if (open_ == item_count_) return;
    runs_.grow(run_count_ + 1, run_count_);
    runs_[run_count_++] = {bodies.body_a, bodies.body_b, static_cast<uint32_t>(open_),
                           static_cast<uint32_t>(item_count_ - open_)};
    open_ = item_count_;
  }

  std::span<const Run> runs() const { return {runs_.data(), run_count_}; }
  const Item* items() const { return items_.data(); }
  uint64_t times_grown() const { return uint64_t{items_.times_grown()} + runs_.times_grown(); }

 private:
  GrowBuffer<Item> items_;
  GrowBuffer<Run> runs_;
  size_t item_count_ = 0, run_count_ = 0, open_ = 0;
};

/// Those of all tasks. Items become rows where they are put in order.
template <typename Row, typename Item = Row>
class OrderedRows {
 public:
  /// each_task(visit) calls visit(found rows of a task), the same each time; row_of(body a, body b,
  /// item); add(sum, row) adds a row to a sum. Returns the sum of all.
  template <typename EachTask, typename RowOf, typename Add>
  EventSum take(size_t bodies, Workers& workers, const EachTask& each_task, const RowOf& row_of,
                const Add& add);
  /// Leaves out all that leave_out(row) names.
  template <typename LeaveOut>
  void remove(const LeaveOut& leave_out) {
    Row* const first = rows_.data();
    count_ = static_cast<size_t>(std::remove_if(first, first + count_, leave_out) - first);
  }

  std::span<const Row> all() const { return {rows_.data(), count_}; }
  uint64_t times_grown() const {
    return runs_.times_grown() + rows_.times_grown() + sums_.times_grown();
  }

 private:
  SortedRuns<Item> runs_;
  GrowBuffer<Row> rows_;
  GrowBuffer<EventSum> sums_;  // by block
  size_t count_ = 0;
};

template <typename Row, typename Item>
template <typename EachTask, typename RowOf, typename Add>
EventSum OrderedRows<Row, Item>::take(size_t bodies, Workers& workers, const EachTask& each_task,
                                      const RowOf& row_of, const Add& add) {
  runs_.sort(bodies, workers, [&](const auto& visit) {
    each_task([&](const FoundRows<Item>& found) {
      for (const auto& run : found.runs())
        visit(typename SortedRuns<Item>::Found{run.body_a,
                                               {run.body_b, run.count, found.items() + run.first}});
    });
  });
  count_ = runs_.item_count();
  rows_.resize(count_);
  sums_.resize(runs_.block_count());
  workers.for_blocks(static_cast<int>(runs_.block_count()), [&](int index, int) {
    const auto block = static_cast<size_t>(index);
    Row* out = rows_.data() + runs_.items_before(block);
    EventSum sum;
    runs_.for_runs(block, [&](size_t body_a, const auto& run) {
      for (uint32_t i = 0; i < run.count; ++i) {
        *out = row_of(body_a, run.body_b, run.items[i]);
        add(sum, *out++);
      }
    });
    sums_[block] = sum;
  });
  EventSum sum;
  for (size_t block = 0; block < runs_.block_count(); ++block) sum += sums_[block];
  return sum;
}

}  // namespace throng
