// Distances of a frame: every pair of parts within a margin, of each two bodies the nearest pair,
// and where parts touch. Works in the tasks of the narrow phase, on the bodies that it has posed.
// Its bounds also say which or-DOPs overlap, so that nobody needs to test them again.
// One rule: rows are the same for any number of threads, SIMD target and pair search.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "culling/distance/found_rows.h"
#include "culling/distance/near_parts.h"
#include "culling/distance/past_poses.h"
#include "culling/stages/broad_phase.h"
#include "culling/stages/pass.h"

namespace throng {

/// What bodies are searched within.
Margins margins_of(const NearOptions& near);

class NearSearch {
 public:
  /// Keeps references to `types` and `workers`.
  NearSearch(BodyTypes types, const CullerOptions& options, Workers& workers);
  /// Somebody else counts what boxes do, see box_counters().
  void share_boxes() { shares_boxes_ = true; }

  /// A frame: begin_frame(), every task once on any worker, end_frame(). Spans returned earlier
  /// become invalid.
  void begin_frame(const PartStageFrame& frame, const BodiesView& bodies, size_t tasks);
  /// A task: begin() with the posed bodies, add() pairs of their slots, bound(), finish(). Under a
  /// deadline the bodies stay posed until end_frame().
  void begin(int worker, const PosedBodies& bodies);
  /// `inner`: as BroadPhase has it of the pairs.
  void add(int worker, std::span<const SlotPair> pairs, std::span<const uint8_t> inner);
  void bound(int worker, size_t task);
  /// `touches`: of each candidate, where triangles have been asked already; else empty.
  void finish(int worker, size_t task, std::span<const uint8_t> touches);
  /// Behind bound(), until the next begin().
  const NearParts& parts(int worker) const { return parts_[static_cast<size_t>(worker)]; }
  void end_frame(StageCounters& counters);
  /// Of a frame, over all workers.
  PartCandidates::Counters box_counters() const;

  /// Behind end_frame(): leaves out contact points of pairs that are not among these, sorted. Under
  /// a deadline the narrow phase may have got no farther than whole bodies.
  void keep_contact_points(std::span<const PairKey> touching);

  /// Sorted by their keys.
  NearRows pairs() const {
    return lists_intervals() ? NearRows(intervals_.all()) : NearRows(pairs_.all());
  }
  /// One for each two bodies, sorted.
  NearRows bodies() const { return nearest_.all(); }
  /// Of those that touch, sorted.
  std::span<const ContactPoint> contact_points() const { return contacts_.all(); }
  /// Of every row so far: its key, its interval and its level.
  uint64_t hash() const { return hash_.value(); }
  /// The hash, and where bodies were, which closing speeds depend on.
  void archive(Archive& a);
  uint64_t times_grown() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// Two bodies and their candidates.
  struct Pair {
    BodyPair bodies;
    float least_m;  ///< no two parts of theirs are nearer
    uint32_t first, count;
    bool is_decided;  ///< by triangles
  };
  struct Urgent {
    Pair* pair;
  };
  /// What a task finds.
  struct Task {
    const PosedBodies* posed = nullptr;
    GrowBuffer<Pair> pairs;
    GrowBuffer<NearCandidate> candidates;
    size_t pair_count = 0, candidate_count = 0;
    FoundRows<NearCandidate> intervals;
    FoundRows<NearPair> rows, nearest;
    FoundRows<ContactPoint> contacts;
    NearCounters counters;
    NearDecider
        decider;  // a task's, not a worker's: whoever runs it finds the memory that it needs
    uint64_t times_grown() const;
  };

  /// By volumes alone, with nothing more to find out of a pair of bodies.
  bool lists_intervals() const { return !options_.exact && options_.near.body_near_m == 0; }
  bool needs_past() const {
    return options_.exact && options_.near.is_asked() && options_.near.step_s > 0;
  }
  NearVerdict verdict_of(const PartPair& parts, const NearCandidate& candidate, float within_m,
                         Task& task) const;
  void list_intervals(const NearParts& parts, Task& task);
  void note_past(size_t index, const PosedBodies& posed);
  size_t narrow(const BodyPair& bodies, std::span<NearCandidate> candidates, Task& task) const;
  void narrow_wide(const BodyPair& bodies, const PartPair& parts, NearCandidate& candidate,
                   Task& task) const;
  void take_candidates(const NearParts& parts, std::span<const uint8_t> touches, Task& task);
  void plan_budget();
  void decide(Task& task);
  class NearestParts;
  static std::span<NearCandidate> sorted(const Pair& pair, Task& task);
  bool is_listed(const NearCandidate& candidate) const;
  void list(const Pair& pair, Task& task);
  void list_undecided(const Pair& pair, Task& task);
  void list_nearest_undecided(const Pair& pair, Task& task);
  EventSum take_rows();
  template <typename Item, typename Row, typename RowOf>
  EventSum take(FoundRows<Item> Task::*found, OrderedRows<Row, Item>& rows, uint64_t kind,
                const RowOf& row_of);
  NearInterval interval_of(size_t body_a, size_t body_b, const NearCandidate& candidate) const;
  NearPair decided(const Task& task, const BodyPair& bodies, const NearCandidate& candidate,
                   const NearVerdict& verdict) const;
  float closing_mps(const Task& task, const BodyPair& bodies, const NearCandidate& candidate,
                    const NearVerdict& verdict) const;

  BodyTypes types_;
  std::vector<uint8_t> has_surfaces_;  // by type
  CullerOptions options_;
  Margins margins_;
  Workers& workers_;
  std::vector<NearParts> parts_;  // one a worker
  bool shares_boxes_ = false;
  // Of the frame.
  PartStageFrame frame_{};
  BodiesView bodies_{};
  Clock::time_point until_;
  std::vector<Task> tasks_;
  size_t task_count_ = 0;

  GrowBuffer<Urgent> urgent_;  // under a deadline: the nearest first
  PastPoses past_;
  OrderedRows<NearInterval, NearCandidate> intervals_;  // instead of pairs_, see lists_intervals()
  OrderedRows<NearPair> pairs_, nearest_;
  OrderedRows<ContactPoint> contacts_;
  EventHash hash_;
  uint64_t frame_number_ = 0;
};

}  // namespace throng
