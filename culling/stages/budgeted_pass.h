// The narrow phase under a deadline (time-critical collision handling after Hubbard, Approximating
// Polyhedra with Spheres for Time-Critical Collision Detection, ACM ToG 15(3), 1996): the most
// urgent pairs of bodies are refined first, and what is left is reported as far as it came.
// One rule: nothing is dropped; a budget of tests gives the same answer for any number of threads,
// SIMD target and pair search.
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

// The order in which a deadline lets pairs of bodies be refined: who touched in the last frame
// first, then whose spheres overlap deepest.
// One rule: what is taken depends on the pairs alone, not on the order in which they were found.

/// Two bodies whose spheres overlap; the smaller the rank, the more urgent.
struct UrgentPair {
  SlotPair slots;
  uint32_t rank;
};

class UrgencyQueue {
 public:
  /// The frame's pairs of bodies. `touched`: pairs of parts, sorted, whose bodies go first.
  void fill(const BodiesView& bodies, const BroadPhase& broad, const Slots& slots,
            std::span<const PairKey> touched, Workers& workers);

  bool empty() const { return next_ == count_; }
  /// Everything that was not taken.
  std::span<const UrgentPair> rest() const { return {pairs_.data() + next_, count_ - next_}; }

  /// The next pairs, at least `target_count` if there are as many, cut only where the order between
  /// them does not matter: for who refines all of them.
  std::span<const UrgentPair> peek(size_t target_count) const;
  /// Brings the next `target_count` pairs into their exact order.
  void sort_next(size_t target_count, const Slots& slots);
  /// The next `target_count` pairs, in exact order as far as sort_next() went.
  std::span<const UrgentPair> peek_sorted(size_t target_count) const;
  /// True while sort_next() has begun a group that is not yet taken.
  bool sorting() const { return next_ < sorted_; }
  void take(size_t count) { next_ += count; }

  uint64_t times_grown() const;

 private:
  void mark_touched(const BodiesView& bodies, std::span<const PairKey> touched);
  bool touched_before(uint32_t body_a, uint32_t body_b, const BodiesView& bodies,
                      std::span<const PairKey> touched) const;
  void scatter_by_group();
  size_t group_end(size_t at) const;

  GrowBuffer<UrgentPair> found_, pairs_;  // as the search lists them; by group
  GrowBuffer<size_t> first_of_block_;
  GrowBuffer<uint32_t> first_touched_;  // by body: where its pairs begin in `touched`
  GrowBuffer<uint32_t> group_start_;
  size_t count_ = 0;
  size_t next_ = 0;    // first pair not taken
  size_t sorted_ = 0;  // pairs before it are in exact order or taken
};

class BudgetedPass final : public Pass {
 public:
  BudgetedPass(BodyTypes types, const CullerOptions& options, Workers& workers);

  void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
           CullingCounters& counters) override;
  void finish(PairEvents& events) override;
  /// The levels of the last frame's pairs, on which the next frame's order depends.
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
  /// A frame's pairs, sorted, with the level of each.
  struct Reported {
    GrowBuffer<PairKey> keys;
    GrowBuffer<uint8_t> levels;
    size_t count = 0;
  };
  /// What a frame refines with.
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
  std::vector<MidPhase> stages_;     // one a task of a wave, whoever runs it
  std::vector<uint64_t> max_exact_;  // by task: triangle tests that it may make
  std::vector<size_t> decided_;      // by task: candidates whose answer is final
  PosedBodies bodies_;               // posed so far in this frame
  GrowBuffer<SlotPair> wave_pairs_;

  // The budget of the frame.
  uint64_t tests_left_ = 0;
  uint64_t worst_tests_;  // that a pair of bodies can take
  Clock::time_point deadline_;
  double pair_ns_ = 0;    // of the latest wave
  double events_ns_ = 0;  // of the last frame's sorting and merging: kept back for this one's

  GrowBuffer<KeyWithLevel> found_, sorted_;
  size_t found_count_ = 0;
  GrowBuffer<uint32_t> start_of_body_;
  Reported current_, previous_;
  GrowBuffer<PairKey> touched_;
  size_t touched_count_ = 0;
  std::array<uint64_t, kPairLevels> reported_{};
};

}  // namespace throng
