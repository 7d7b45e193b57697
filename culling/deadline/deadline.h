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

#include "culling/deadline/urgency.h"
#include "culling/pair_level.h"
#include "culling/stages/part_stage.h"
#include "culling/stages/posed_bodies.h"

namespace throng {

class Deadline {
 public:
  Deadline(const CullerOptions& options, Workers& workers);

  /// Refines the pairs of `broad` until the budget is up; `start` is when the frame's clock began.
  void refine(std::chrono::steady_clock::time_point start, const BodiesView& bodies,
              const PosedBodies::Frame& posing, const BroadPhase& broad,
              const PartStageFrame& shared);
  /// Sorts what refine() found and merges it with the last frame's pairs.
  void take_events(const BodiesView& bodies, PairEvents& events);
  /// The levels of the last frame's pairs, on which the next frame's order depends; `touching` are
  /// these pairs.
  void archive(Archive& a, std::span<const PairKey> touching);
  /// The run stops: everything ends.
  void finish(PairEvents& events);

  /// One for each of PairEvents::touching(), and one for each of its events: an end has the level
  /// at which the pair was last reported.
  std::span<const uint8_t> levels() const { return {now_.levels.data(), now_.count}; }
  std::span<const uint8_t> event_levels() const {
    return {event_levels_.data(), event_level_count_};
  }
  const std::array<uint64_t, kPairLevels>& reported() const { return reported_; }

  PartStageCounters counters() const;
  const PosedBodies::Counters& posed() const { return bodies_.counters(); }
  uint64_t times_grown() const;

 private:
  struct LeveledKey {
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
    const PosedBodies::Frame& posing;
    const PartStageFrame& shared;
  };

  using Clock = std::chrono::steady_clock;

  void find_touched();
  std::span<const UrgentPair> next_wave(const Slots& slots);
  void refine_wave(const Frame& frame, std::span<const UrgentPair> wave);
  void pose(const Frame& frame, std::span<const UrgentPair> wave);
  size_t test_bodies(const Frame& frame, std::span<const UrgentPair> wave);
  void cut_pairs(const Frame& frame, size_t tasks);
  void cut_candidates(size_t tasks);
  void cut_triangles(size_t tasks);
  void report(const PartStage& stage, size_t decided);
  void add(PairKey key, PairLevel level);
  void sort_found(size_t bodies);
  void find_event_levels(const PairEvents& events);
  bool time_is_up() const;
  uint64_t worst_tests(const PartStageFrame& shared) const;

  CullerOptions options_;
  Workers& workers_;
  UrgencyQueue queue_;
  std::vector<PartStage> stages_;     // one a task of a wave, whoever runs it
  std::vector<uint64_t> most_exact_;  // by task: triangle tests that it may make
  std::vector<size_t> decided_;       // by task: candidates whose answer is final
  PosedBodies bodies_;                // posed so far in this frame
  GrowBuffer<SlotPair> wave_pairs_;

  // The budget of the frame.
  uint64_t tests_left_ = 0;
  uint64_t worst_tests_ = 0;  // that a pair of bodies can take
  Clock::time_point until_;
  double pair_ns_ = 0;    // of the latest wave
  double events_ns_ = 0;  // of the last frame's sorting and merging: kept back for this one's

  GrowBuffer<LeveledKey> found_, sorted_;
  size_t found_count_ = 0;
  GrowBuffer<uint32_t> start_of_body_;
  Reported now_, was_;
  GrowBuffer<PairKey> touched_;
  size_t touched_count_ = 0;
  GrowBuffer<uint8_t> event_levels_;
  size_t event_level_count_ = 0;
  std::array<uint64_t, kPairLevels> reported_{};
};

}  // namespace throng
