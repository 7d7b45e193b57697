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
#include "culling/stages/part_stage.h"
#include "culling/stages/pass.h"
#include "culling/stages/posed_bodies.h"
#include "culling/stages/shared_stages.h"

namespace throng {

class Deadline final : public Pass {
 public:
  Deadline(BodyTypes types, const CullerOptions& options, Workers& workers);

  void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
           CullingCounters& counters) override;
  void finish(PairEvents& events) override;
  /// The levels of the last frame's pairs, on which the next frame's order depends.
  void archive(Archive& a, std::span<const PairKey> touching) override;
  std::span<const uint8_t> levels() const override { return {now_.levels.data(), now_.count}; }
  EventHashKind hash_kind() const override { return EventHashKind::kEventsAndLevels; }
  uint64_t times_grown() const override;

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
    PosedBodies::Frame posing;
    PartStageFrame parts;
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
  void report(const PartStage& stage, size_t decided);
  void add(PairKey key, PairLevel level);
  void sort_found(size_t bodies);
  void take_events(const BodiesView& bodies, PairEvents& events);
  void level_events(PairEvents& events) const;
  bool time_is_up() const;

  CullerOptions options_;
  Workers& workers_;
  SharedStages shared_;
  UrgencyQueue queue_;
  std::vector<PartStage> stages_;    // one a task of a wave, whoever runs it
  std::vector<uint64_t> max_exact_;  // by task: triangle tests that it may make
  std::vector<size_t> decided_;      // by task: candidates whose answer is final
  PosedBodies bodies_;               // posed so far in this frame
  GrowBuffer<SlotPair> wave_pairs_;

  // The budget of the frame.
  uint64_t tests_left_ = 0;
  uint64_t worst_tests_;  // that a pair of bodies can take
  Clock::time_point until_;
  double pair_ns_ = 0;    // of the latest wave
  double events_ns_ = 0;  // of the last frame's sorting and merging: kept back for this one's

  GrowBuffer<LeveledKey> found_, sorted_;
  size_t found_count_ = 0;
  GrowBuffer<uint32_t> start_of_body_;
  Reported now_, was_;
  GrowBuffer<PairKey> touched_;
  size_t touched_count_ = 0;
  std::array<uint64_t, kPairLevels> reported_{};
};

}  // namespace throng
