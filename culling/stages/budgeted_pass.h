// BudgetedPass refines the most urgent pairs of bodies within a budget per frame. It reports the
// other pairs at the level they reached. Method: Hubbard, Approximating Polyhedra with Spheres for
// Time-Critical Collision Detection, ACM ToG 15(3), 1996.
// Invariant: no pair is dropped; with a budget of tests the result is the same for any number of
// threads, SIMD target and pair search.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/kernels/kernels.h"
#include "culling/pair.h"
#include "culling/stages/broad_phase.h"
#include "culling/stages/mid_phase.h"
#include "culling/stages/pass.h"
#include "culling/stages/posed_bodies.h"
#include "culling/stages/shared_stages.h"
#include "culling/stages/slots.h"

namespace throng {

// UrgencyQueue orders pairs of bodies: first those that touched in the last frame, then those whose
// spheres overlap deepest.
// Invariant: the order depends only on the pairs, not on the order in which they were found.

/// Two bodies with overlapping spheres. A smaller rank is more urgent.
struct UrgentPair {
  SlotPair slots;
  uint32_t rank;
};

class UrgencyQueue {
 public:
  /// Sets the pairs of bodies of a frame; first those of `touched`, sorted pairs of parts.
  void fill(const BodiesView& bodies, const BroadPhase& broad, const Slots& slots,
            std::span<const PairKey> touched, Workers& workers);

  bool empty() const { return next_ == count_; }
  std::span<const UrgentPair> rest() const { return {pairs_.data() + next_, count_ - next_}; }

  /// Next pairs, at least `target_count` if available, up to a group border.
  std::span<const UrgentPair> peek(size_t target_count) const;
  /// Sorts the next `target_count` pairs exactly.
  void sort_next(size_t target_count, const Slots& slots);
  /// Next `target_count` pairs, in exact order up to the last sort_next().
  std::span<const UrgentPair> peek_sorted(size_t target_count) const;
  /// True if sort_next() has begun a group that is not yet taken.
  bool sorting() const { return next_ < sorted_; }
  void take(size_t count) { next_ += count; }

  uint64_t times_grown() const;

 private:
  void mark_touched(const BodiesView& bodies, std::span<const PairKey> touched);
  bool touched_before(uint32_t body_a, uint32_t body_b, const BodiesView& bodies,
                      std::span<const PairKey> touched) const;
  void scatter_by_group();
  size_t group_end(size_t at) const;

  GrowBuffer<UrgentPair> found_, pairs_;  // in search order; by group
  GrowBuffer<size_t> first_of_block_;
  GrowBuffer<uint32_t> first_touched_;  // by body: start of its pairs in `touched`
  GrowBuffer<uint32_t> group_start_;
  size_t count_ = 0;
  size_t next_ = 0;    // index of the first pair not taken
  size_t sorted_ = 0;  // pairs before this index are in exact order or taken
};

class BudgetedPass final : public Pass {
 public:
  BudgetedPass(BodyTypes types, const CullerOptions& options, Workers& workers);

  void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
           CullingCounters& counters) override;
  void finish(PairEvents& events) override;
  /// Levels of the last frame's pairs, which determine the order of the next frame.
  void archive(Archive& a, std::span<const PairKey> touching) override;
  std::span<const uint8_t> levels() const override {
    return {current_.levels.data(), current_.count};
  }
  EventHashKind hash_kind() const override { return EventHashKind::kEventsAndLevels; }
  uint64_t times_grown() const override;

 private:
  struct KeyWithLevel {
    PairKey key;
    uint8_t level;
  };
  /// Sorted pairs of a frame and their levels.
  struct Reported {
    GrowBuffer<PairKey> keys;
    GrowBuffer<uint8_t> levels;
    size_t count = 0;
  };
  struct Frame {
    PosedBodies::Frame posing;
    MidPhaseFrame parts;
  };

  using Clock = std::chrono::steady_clock;

  void begin_budget();
  void refine(const BodiesView& bodies, const PoseSource& source);
  void find_touched();
  std::span<const UrgentPair> next_wave(const Slots& slots);
  void refine_wave(const Frame& frame, std::span<const UrgentPair> wave);
  void pose(const Frame& frame, std::span<const UrgentPair> wave);
  size_t test_bodies(const Frame& frame, std::span<const UrgentPair> wave);
  void cut_pairs(const Frame& frame, size_t tasks);
  void cut_candidates(size_t tasks);
  void cut_triangles(size_t tasks);
  void report(const MidPhase& stage, size_t decided);
  void add(PairKey key, PairLevel level);
  void sort_found(size_t bodies);
  void take_events(const BodiesView& bodies, PairEvents& events);
  void level_events(PairEvents& events) const;
  bool time_is_up() const;

  CullerOptions options_;
  Workers& workers_;
  SharedStages shared_;
  UrgencyQueue queue_;
  std::vector<MidPhase> stages_;     // by task of a wave, independent of the worker
  std::vector<uint64_t> max_exact_;  // by task: maximum number of triangle tests
  std::vector<size_t> decided_;      // by task: number of candidates with a final result
  PosedBodies bodies_;               // bodies posed so far in this frame
  GrowBuffer<SlotPair> wave_pairs_;

  uint64_t tests_left_ = 0;
  uint64_t max_tests_per_pair_;
  Clock::time_point deadline_;
  double pair_ns_ = 0;    // time per pair in the latest wave
  double events_ns_ = 0;  // time of the last frame's sorting and merging, reserved in this frame

  GrowBuffer<KeyWithLevel> found_, sorted_;
  size_t found_count_ = 0;
  GrowBuffer<uint32_t> start_of_body_;
  Reported current_, previous_;
  GrowBuffer<PairKey> touched_;
  size_t touched_count_ = 0;
  std::array<uint64_t, kPairLevels> reported_{};
};

}  // namespace throng
