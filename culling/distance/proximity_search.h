// ProximitySearch lists pairs of parts within a margin, the closest parts of bodies, and contact
// points of a frame. It runs in the tasks of the mid phase, on the bodies posed there. Its bounds
// also decide which or-DOPs overlap, so that they are tested only once.
// Invariant: rows are the same for any number of threads, SIMD target and pair search.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/memory.h"
#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/distance/proximity_candidates.h"
#include "culling/event_hash.h"
#include "culling/kernels/kernels.h"
#include "culling/stages/broad_phase.h"
#include "culling/stages/pass.h"
#include "culling/stages/posed_bodies.h"
#include "culling/stages/shared_stages.h"
#include "culling/stages/sorted_runs.h"

namespace throng {

// TaskRows collects rows of tasks, per pair of bodies; OrderedRows sorts those of all tasks by key.
// Invariant: rows of a task stay in place until they have been taken.

template <typename Item>
class TaskRows {
 public:
  struct Run {
    uint32_t body_a, body_b, first, count;
  };

  void clear() { item_count_ = run_count_ = open_ = 0; }
  void add(const Item& item) {
    items_.grow(item_count_ + 1, item_count_);
    items_[item_count_++] = item;
  }
  /// Rows added since the last run ended. The caller sorts them by key.
  std::span<Item> open() { return {items_.data() + open_, item_count_ - open_}; }
  /// Reserves memory for more rows, at the end of open(). add(count) then appends them.
  Item* reserve(size_t more) {
    items_.grow(item_count_ + more, item_count_);
    return items_.data() + item_count_;
  }
  void commit(size_t count) { item_count_ += count; }
  /// Ends a run: open() are the rows of these two bodies.
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

/// Rows of all tasks. Items are converted to rows when they are sorted.
template <typename Row, typename Item = Row>
class OrderedRows {
 public:
  /// each_task(visit) calls visit(rows of a task), identically on each call. row_of(body a, body b,
  /// item) converts an item; add(sum, row) adds a row. Returns the sum of all rows.
  template <typename EachTask, typename RowOf, typename Add>
  EventSum take(size_t bodies, Workers& workers, const EachTask& each_task, const RowOf& row_of,
                const Add& add);
  /// Removes all rows for which leave_out(row) is true.
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
    each_task([&](const TaskRows<Item>& found) {
      for (const auto& run : found.runs())
        visit(typename SortedRuns<Item>::BodyRun{
            run.body_a, {run.body_b, run.count, found.items() + run.first}});
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

// PreviousPoses keeps the part poses of the last frame, for closing speeds.
// Invariant: a task records all bodies that it has posed, including those of other tasks; content
// and memory depend on the frame alone.

class PreviousPoses {
 public:
  struct Body {
    uint32_t id, parts;
    float scale;
    std::array<double, 3> root_m;
    const PartPose* poses;
  };

  void begin_frame(size_t tasks);
  /// Records bodies that a task has posed; parts_of(type) is 0 for static bodies.
  template <typename PartsOf>
  void record(size_t task, std::span<const PosedBody> bodies, const PartPose* poses,
              const BodiesView& view, const PartsOf& parts_of);
  /// Makes the recorded poses the previous ones.
  void end_frame();

  /// Body in the last frame, or null if it was not recorded.
  const Body* find(uint32_t id) const;
  void archive(Archive& a);
  uint64_t times_grown() const;

 private:
  struct Task {
    GrowBuffer<Body> bodies;
    GrowBuffer<PartPose> poses;
    size_t body_count = 0, pose_count = 0;
  };
  using Tasks = std::vector<Task>;

  void restore(Archive& a, uint64_t count);

  std::array<Tasks, 2> tasks_;  // this frame and the last, alternating
  size_t current_ = 0, task_count_ = 0;
  GrowBuffer<Body> previous_;  // by id, without duplicates
  size_t previous_count_ = 0;
};

template <typename PartsOf>
void PreviousPoses::record(size_t task, std::span<const PosedBody> bodies, const PartPose* poses,
                           const BodiesView& view, const PartsOf& parts_of) {
  Task& own = tasks_[current_][task];
  for (const PosedBody& body : bodies) {
    const auto parts = static_cast<size_t>(parts_of(body.slot.type));
    if (parts == 0) continue;
    own.bodies.grow(own.body_count + 1, own.body_count);
    own.bodies[own.body_count++] = {view.ids[body.slot.body], static_cast<uint32_t>(parts),
                                    body.slot.scale, body.slot.root_m, nullptr};
    own.poses.grow(own.pose_count + parts, own.pose_count);
    std::copy_n(poses + body.pose, parts, own.poses.data() + own.pose_count);
    own.pose_count += parts;
  }
}

/// Margins of the broad phase for these options.
Margins margins_of(const ProximityOptions& options);

class ProximitySearch {
 public:
  /// Keeps references to `types` and `workers`.
  ProximitySearch(BodyTypes types, const CullerOptions& options, Workers& workers);
  /// Disables counting of boxes, for callers that count box_counters() themselves.
  void share_boxes() { shares_boxes_ = true; }

  /// Frame: begin_frame(), every task once on any worker, end_frame(). Invalidates earlier spans.
  void begin_frame(const MidPhaseFrame& frame, const BodiesView& bodies, size_t tasks);
  /// Runs a task: begin() with the posed bodies, add() for pairs of their slots, bound(), finish().
  /// With a budget the bodies must stay posed until end_frame().
  void begin(int worker, const PosedBodies& bodies);
  /// `inner`: flags of the pairs as in BroadPhase::inner().
  void add(int worker, std::span<const SlotPair> pairs, std::span<const uint8_t> inner);
  void bound(int worker, size_t task);
  /// `touches`: triangle result per candidate if triangles were tested already; otherwise empty.
  void finish(int worker, size_t task, std::span<const uint8_t> touches);
  /// Candidates of a worker's task, from bound() until the next begin().
  const ProximityCandidates& parts(int worker) const { return parts_[static_cast<size_t>(worker)]; }
  void end_frame(StageCounters& counters);
  /// Counters of a frame, over all workers.
  PartCandidates::Counters box_counters() const;

  /// After end_frame(): drops contact points of pairs that are not in `touching` (sorted). With a
  /// budget the narrow phase may have stopped at whole bodies.
  void keep_contact_points(std::span<const PairKey> touching);

  /// Pairs of parts, sorted by key.
  ProximityRows pairs() const {
    return lists_bounds_only() ? ProximityRows(intervals_.all()) : ProximityRows(pairs_.all());
  }
  /// Closest parts, one row per pair of bodies, sorted.
  ProximityRows bodies() const { return nearest_.all(); }
  /// Contact points, sorted by key.
  std::span<const ContactPoint> contact_points() const { return contacts_.all(); }
  /// Hash of all rows so far: key, distance bounds and level.
  uint64_t hash() const { return hash_.value(); }
  /// Reads or writes the hash and the previous poses, which closing speeds depend on.
  void archive(Archive& a);
  uint64_t times_grown() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct Pair {
    BodyPair bodies;
    float min_distance_m;  ///< lower bound of the distance of their parts
    uint32_t first, count;
    bool is_decided;  ///< true: by triangles
  };
  struct Urgent {
    Pair* pair;
  };
  struct Task {
    const PosedBodies* posed = nullptr;
    GrowBuffer<Pair> pairs;
    GrowBuffer<ProximityCandidate> candidates;
    size_t pair_count = 0, candidate_count = 0;
    TaskRows<ProximityCandidate> intervals;
    TaskRows<ProximityPair> rows, nearest;
    TaskRows<ContactPoint> contacts;
    ProximityCounters counters;
    TriangleQuery decider;  // owned by the task, so that any worker finds its memory
    uint64_t times_grown() const;
  };

  /// True if volumes alone decide and no closest parts are requested.
  bool lists_bounds_only() const {
    return !options_.exact && options_.proximity.closest_margin_m == 0;
  }
  bool needs_previous_poses() const {
    return options_.exact && options_.proximity.is_enabled() && options_.proximity.step_s > 0;
  }
  DistanceResult result_of(const PartPair& parts, const ProximityCandidate& candidate,
                           float within_m, Task& task) const;
  void list_intervals(const ProximityCandidates& parts, Task& task);
  void record_poses(size_t index, const PosedBodies& posed);
  size_t tighten(const BodyPair& bodies, std::span<ProximityCandidate> candidates,
                 Task& task) const;
  void tighten_wide(const BodyPair& bodies, const PartPair& parts, ProximityCandidate& candidate,
                    Task& task) const;
  void take_candidates(const ProximityCandidates& parts, std::span<const uint8_t> touches,
                       Task& task);
  void plan_budget();
  void decide(Task& task);
  class ClosestParts;
  static std::span<ProximityCandidate> sorted(const Pair& pair, Task& task);
  bool is_listed(const ProximityCandidate& candidate) const;
  void list(const Pair& pair, Task& task);
  void list_undecided(const Pair& pair, Task& task);
  void list_nearest_undecided(const Pair& pair, Task& task);
  EventSum take_rows();
  template <typename Item, typename Row, typename RowOf>
  EventSum take(TaskRows<Item> Task::*found, OrderedRows<Row, Item>& rows, uint64_t kind,
                const RowOf& row_of);
  DistanceBounds interval_of(size_t body_a, size_t body_b,
                             const ProximityCandidate& candidate) const;
  ProximityPair decided(const Task& task, const BodyPair& bodies,
                        const ProximityCandidate& candidate, const DistanceResult& result) const;
  float closing_speed_mps(const Task& task, const BodyPair& bodies,
                          const ProximityCandidate& candidate, const DistanceResult& result) const;

  BodyTypes types_;
  std::vector<uint8_t> has_surfaces_;  // by type
  CullerOptions options_;
  Margins margins_;
  Workers& workers_;
  std::vector<ProximityCandidates> parts_;  // by worker
  bool shares_boxes_ = false;
  MidPhaseFrame frame_{};
  BodiesView bodies_{};
  Clock::time_point deadline_;
  std::vector<Task> tasks_;
  size_t task_count_ = 0;

  GrowBuffer<Urgent> urgent_;  // with a budget: nearest first
  PreviousPoses previous_;
  OrderedRows<DistanceBounds, ProximityCandidate>
      intervals_;  // replaces pairs_, see lists_bounds_only()
  OrderedRows<ProximityPair> pairs_, nearest_;
  OrderedRows<ContactPoint> contacts_;
  EventHash hash_;
  uint64_t frame_number_ = 0;
};

// BudgetedProximity computes distances within a budget. It searches and poses separately from the
// narrow phase, which refines only a part of the pairs. All pairs within the margin are listed;
// triangles are tested until the budget is used up.
// Invariant: contacts are the same with and without distances.

class BudgetedProximity {
 public:
  /// Keeps references to `types`, `workers` and `search`.
  BudgetedProximity(BodyTypes types, const CullerOptions& options, Workers& workers,
                    ProximitySearch& search);

  void run(const BodiesView& bodies, const PoseSource& source, StageCounters& counters);
  uint64_t times_grown() const { return shared_.times_grown() + posed_.times_grown(); }

 private:
  Workers& workers_;
  ProximitySearch& proximity_;
  SharedStages shared_;
  PosedBodies posed_;
};

}  // namespace throng
