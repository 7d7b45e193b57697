// Narrow phase: from pairs of bodies whose spheres overlap to pairs of parts.
// One rule: works on one task at a time with buffers of its own, so that tasks can run on any
// thread in any order.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/grow_buffer.h"
#include "base/pose.h"
#include "culling/body_type.h"
#include "culling/counters.h"
#include "culling/kernels/kernels.h"
#include "culling/pair.h"
#include "culling/part_tally.h"
#include "culling/stages/posed_bodies.h"
#include "culling/stages/slots.h"

namespace throng {

/// What all tasks of a frame read.
struct PartStageFrame {
  std::span<const std::shared_ptr<const BodyType>> types;
  std::span<const uint16_t> shape_type;  ///< type of each shape that has buckets
  std::span<const uint16_t> type_first_shape;
  std::span<const uint16_t> type_parts;
  const Kernels* kernels;
  VolumeKind volume;
  bool is_mixed;  ///< parts have volumes of their own, see PartShape::volume
  bool exact;

  VolumeKind volume_of(size_t type, size_t part) const {
    return types[type]->parts()[part].volume.value_or(volume);
  }
};

/// N and time of one worker; summed up in any order.
struct PartStageCounters {
  StageCounters body_box, box, part, exact;
  uint64_t primitive_tests = 0;
  void add(const PartStageCounters& other);
};

/// The overlapping parts of one pair of bodies, consecutive and sorted.
struct PartRun {
  uint32_t body_a, body_b;  ///< indices into the BodiesView, a < b
  uint32_t first, count;
};

/// What a task yields.
struct PartPairs {
  GrowBuffer<uint16_t> parts;  ///< PairKey::parts_of()
  GrowBuffer<PartRun> runs;
  size_t run_count = 0;
  uint32_t times_grown() const { return parts.times_grown() + runs.times_grown(); }
};

/// Makes what the stage will read of a type, for each of `volumes`.
void fit_for_part_stage(const BodyType& type, std::span<const VolumeKind> volumes, bool exact);

/// Tests that the part boxes of two bodies take.
uint64_t box_tests(const PartStageFrame& frame, const BodyPair& pair);

/// The scratch of one worker.
class PartStage {
 public:
  /// A task: begin() with the posed bodies, add() pairs of their slots, finish().
  void begin(const PartStageFrame& frame, const PosedBodies& bodies);
  void add(const PartStageFrame& frame, std::span<const SlotPair> pairs);
  void finish(const PartStageFrame& frame, PartPairs& out);

  /// finish() step by step, for who may have to stop in between: find_candidates(), test_parts(),
  /// then, where asked, decide_by_triangles().
  void find_candidates(const PartStageFrame& frame);
  void test_parts(const PartStageFrame& frame);
  /// Decides the first `most` candidates that overlap; returns how many candidates are decided.
  size_t decide_by_triangles(const PartStageFrame& frame, uint64_t most);

  /// Pairs of bodies whose boxes overlap, and pairs of parts whose boxes do, in the order of add().
  std::span<const BodyPair> pairs() const { return {pairs_.data(), pair_count_}; }
  std::span<const Candidate> candidates() const { return {candidates_.data(), candidate_count_}; }
  /// One a candidate, after test_parts().
  std::span<const uint8_t> overlaps() const { return {overlaps_.data(), candidate_count_}; }
  PairKey key_of(const Candidate& candidate) const;
  /// Forgets all but the first: what comes next is done for those only.
  void keep_pairs(const PartStageFrame& frame, size_t count);
  void keep_candidates(size_t count) { candidate_count_ = count; }

  /// From now on finish() counts by pair of parts, too.
  void tally_parts() { tally_ = std::make_unique<PartTally>(); }
  const PartTally* tally() const { return tally_.get(); }

  const PartStageCounters& counters() const { return counters_; }
  void clear_counters() { counters_ = {}; }
  /// Makes room for what another worker's task needed: any worker may get that task next time.
  void reserve_like(const PartStage& other);
  uint32_t times_grown() const;

 private:
  void sort_into_buckets();
  /// Calls test(shape a, shape b, candidates of the bucket) for each bucket that is not empty, and
  /// rest(one candidate) for each of shapes beyond the buckets; candidates as indices.
  template <typename Test, typename Rest>
  void for_each_bucket(const Test& test, const Rest& rest);
  template <typename Volume>
  void test_by_kernel(const PartStageFrame& frame);
  void test_mixture(const PartStageFrame& frame);
  template <typename Volume>
  bool overlap(const PartStageFrame& frame, uint32_t candidate) const;
  template <typename Volume>
  void test_one_by_one(const PartStageFrame& frame);
  template <typename Volume>
  void test_one_by_one(const PartStageFrame& frame, std::span<const uint32_t> candidates);
  template <typename Volume>
  void test_by_reference(const PartStageFrame& frame, uint32_t candidate);
  std::span<uint32_t> still_overlapping(std::span<uint32_t> candidates) const;
  void tally_tests(const PartStageFrame& frame);
  void tally_truth(const PartStageFrame& frame);
  void write_runs(PartPairs& out) const;

  const PosedBodies* bodies_ = nullptr;
  BoxFrame boxes_{};
  GrowBuffer<BodyPair> pairs_;
  GrowBuffer<Candidate> candidates_;
  GrowBuffer<uint32_t> bucket_start_, order_;
  GrowBuffer<uint8_t> overlaps_;
  std::unique_ptr<PartTally> tally_;  // null: nobody asks
  size_t pair_count_ = 0, candidate_count_ = 0;
  PartStageCounters counters_;
};

}  // namespace throng
