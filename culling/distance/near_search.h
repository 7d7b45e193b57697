// Distances of a frame: every pair of parts within a margin, of each two bodies the nearest pair,
// and where parts touch. Works beside the narrow phase, task by task, on the bodies that it has
// posed; what touches is found as without it.
// One rule: rows are the same for any number of threads, SIMD target and pair search.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "culling/distance/near_parts.h"
#include "culling/distance/past_poses.h"
#include "culling/stages/pass.h"
#include "culling/stages/sorted_runs.h"

namespace throng {

class NearSearch {
 public:
  /// Keeps references to `types` and `workers`.
  NearSearch(BodyTypes types, const CullerOptions& options, Workers& workers);

  /// A frame: begin_frame(), every task once on any worker, end_frame(). Spans returned earlier
  /// become invalid.
  void begin_frame(const PartStageFrame& frame, const BodiesView& bodies, size_t tasks);
  /// A task: begin() with the posed bodies, add() pairs of their slots, finish(). Under a deadline
  /// the bodies stay posed until end_frame().
  void begin(int worker, const PosedBodies& bodies);
  void add(int worker, std::span<const SlotPair> pairs);
  void finish(int worker, size_t task);
  void end_frame(StageCounters& counters);

  /// Behind end_frame(): leaves out contact points of pairs that are not among these, sorted. Under
  /// a deadline the narrow phase may have got no farther than whole bodies.
  void keep_contact_points(std::span<const PairKey> touching);

  /// Sorted by their keys.
  std::span<const NearPair> pairs() const { return pairs_.all(); }
  /// One for each two bodies, sorted.
  std::span<const NearPair> bodies() const { return nearest_.all(); }
  /// Of those that touch, sorted.
  std::span<const ContactPoint> contact_points() const { return contacts_.all(); }
  /// Of every row so far: its key, its interval and its level.
  uint64_t hash() const { return hash_.value(); }
  /// The hash, and where bodies were, which closing speeds depend on.
  void archive(Archive& a);
  uint64_t times_grown() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// Two bodies, their candidates and what came of them.
  struct Pair {
    BodyPair bodies;
    float least_m;  ///< no two parts of theirs are nearer
    uint32_t first, count;
    uint32_t task;
    bool is_decided = false;  ///< by triangles
    bool by_volumes = false;  ///< every candidate is a row, as it is
    uint32_t first_row = 0, rows = 0;
    uint32_t first_nearest = 0, nearest = 0;  ///< 0 or 1 of them
    uint32_t first_contact = 0, contacts = 0;
  };
  struct Urgent {
    Pair* pair;
  };
  /// What a task finds.
  struct Task {
    const PosedBodies* posed = nullptr;
    GrowBuffer<Pair> pairs;
    GrowBuffer<NearCandidate> candidates;
    GrowBuffer<NearPair> rows, nearest;
    GrowBuffer<ContactPoint> contacts;
    size_t pair_count = 0, candidate_count = 0, row_count = 0, nearest_count = 0;
    size_t contact_count = 0;
    NearCounters counters;
    NearDecider
        decider;  // a task's, not a worker's: whoever runs it finds the memory that it needs
    uint64_t times_grown() const;
  };
  /// Those of all tasks in the order of their keys.
  template <typename Row>
  struct Rows {
    using Runs = SortedRuns<Pair>;
    Runs runs;  ///< a run's items are those of one pair, whatever their number
    GrowBuffer<Row> rows;
    GrowBuffer<EventSum> sums;  ///< by block
    size_t count = 0;

    std::span<const Row> all() const { return {rows.data(), count}; }
    uint64_t times_grown() const {
      return runs.times_grown() + rows.times_grown() + sums.times_grown();
    }
  };

  bool needs_past() const {
    return options_.exact && options_.near.is_asked() && options_.near.step_s > 0;
  }
  NearVerdict verdict_of(const PartPair& parts, const NearCandidate& candidate, float within_m,
                         Task& task) const;
  void take_candidates(const NearParts& parts, uint32_t index);
  void plan_budget();
  void decide(Task& task);
  void narrow(Pair& pair, Task& task);
  void list(Pair& pair, Task& task);
  template <typename Row, typename CountOf, typename Write>
  EventSum take_rows(Rows<Row>& rows, uint64_t kind, const CountOf& count_of, const Write& write);
  NearPair undecided(const BodyPair& bodies, const NearCandidate& candidate) const;
  NearPair decided(const Task& task, const BodyPair& bodies, const NearCandidate& candidate,
                   const NearVerdict& verdict) const;
  float closing_mps(const Task& task, const BodyPair& bodies, const NearCandidate& candidate,
                    const NearVerdict& verdict) const;

  BodyTypes types_;
  CullerOptions options_;
  Workers& workers_;
  std::vector<NearParts> parts_;  // one a worker
  // Of the frame.
  PartStageFrame frame_{};
  BodiesView bodies_{};
  Clock::time_point until_;
  std::vector<Task> tasks_;
  size_t task_count_ = 0;

  GrowBuffer<Urgent> urgent_;  // under a deadline: the nearest first
  PastPoses past_;
  Rows<NearPair> pairs_, nearest_;
  Rows<ContactPoint> contacts_;
  EventHash hash_;
  uint64_t frame_number_ = 0;
};

}  // namespace throng
