// Distances of a frame: every pair of parts within a margin, and of each two bodies the nearest
// pair. A search of its own beside the pass that finds what touches, so that neither changes the
// other. One rule: rows are the same for any number of threads, SIMD target and pair search.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "culling/distance/near_parts.h"
#include "culling/stages/broad_phase.h"
#include "culling/stages/pass.h"

namespace throng {

class NearSearch {
 public:
  /// Keeps references to `types` and `workers`.
  NearSearch(BodyTypes types, const CullerOptions& options, Workers& workers);

  /// Spans returned earlier become invalid.
  void run(const BodiesView& bodies, const PoseSource& source, StageCounters& counters);

  /// Sorted by their keys.
  std::span<const NearPair> pairs() const { return {pairs_.data(), pair_count_}; }
  /// One for each two bodies, sorted.
  std::span<const NearPair> bodies() const { return {nearest_.data(), nearest_count_}; }
  /// Of every row so far: its key, its interval and its level.
  uint64_t hash() const { return hash_.value(); }
  /// The hash, and where bodies were, which closing speeds depend on.
  void archive(Archive& a);
  uint64_t times_grown() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// Two bodies and their candidates.
  struct Pair {
    uint32_t slot_a, slot_b;
    float least_m;  ///< no two parts of theirs are nearer
    uint32_t first, count;
    bool is_decided;  ///< by triangles, where these are asked
  };
  struct Urgent {
    Pair* pair;
  };
  /// What a task finds.
  struct Task {
    GrowBuffer<Pair> pairs;
    GrowBuffer<NearCandidate> candidates;
    GrowBuffer<NearPair> rows, nearest;
    size_t pair_count = 0, candidate_count = 0, row_count = 0, nearest_count = 0;
    NearCounters counters;
    NearDecider
        decider;  // a task's, not a worker's: whoever runs it finds the memory that it needs
    uint32_t times_grown() const;
  };
  /// A body of a frame that was posed.
  struct Was {
    uint32_t id, pose;
    float scale;
    std::array<double, 3> root_m;
  };

  NearBodies bodies_of(const Pair& pair) const;
  void find(size_t task);
  void plan_budget();
  void decide(size_t task);
  void list(const Pair& pair, Task& task);
  NearPair undecided(const NearBodies& bodies, const NearCandidate& candidate) const;
  NearPair decided(const NearBodies& bodies, const NearCandidate& candidate,
                   const NearVerdict& verdict) const;
  float closing_mps(const NearBodies& bodies, const NearCandidate& candidate,
                    const NearVerdict& verdict) const;
  const Was* was(uint32_t id) const;
  void gather();
  void hash_rows();
  void remember(const BodiesView& bodies);

  BodyTypes types_;
  NearOptions options_;
  bool exact_;
  std::optional<double> deadline_ms_;
  std::optional<uint64_t> deadline_tests_;
  const Kernels& kernels_;
  Workers& workers_;
  Slots slots_;
  BroadPhase broad_;
  PosedBodies posed_;
  std::span<const uint32_t> ids_;  // of the frame
  Clock::time_point until_;
  std::vector<Task> tasks_;
  size_t task_count_ = 0;
  GrowBuffer<Urgent> urgent_;  // under a deadline: the nearest first
  GrowBuffer<NearPair> pairs_, nearest_;
  size_t pair_count_ = 0, nearest_count_ = 0;
  EventHash hash_;
  uint64_t frame_ = 0;
  GrowBuffer<Was> was_;  // of the last frame, by id
  GrowBuffer<PartPose> was_poses_;
  size_t was_count_ = 0, was_pose_count_ = 0;
};

}  // namespace throng
