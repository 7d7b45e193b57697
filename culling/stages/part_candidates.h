// PartCandidates lists pairs of parts with nearby boxes, sorted by both part shapes for SIMD.
// Invariant: it uses only its own buffers; tasks may run on any thread in any order.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/memory.h"
#include "culling/body_type.h"
#include "culling/counters.h"
#include "culling/kernels/kernels.h"
#include "culling/pair.h"
#include "culling/pair_filter.h"
#include "culling/stages/posed_bodies.h"
#include "culling/stages/slots.h"

namespace throng {

struct MidPhaseFrame {
  std::span<const std::shared_ptr<const BodyType>> types;
  std::span<const uint16_t> shape_type;  ///< type of each shape that has buckets
  std::span<const uint16_t> type_first_shape;
  std::span<const uint16_t> type_parts;
  const Kernels* kernels;
  const PairFilter* filter;
  VolumeKind volume;
  bool is_mixed;  ///< some parts have their own volumes, see PartShape::volume
  bool exact;

  VolumeKind volume_of(size_t type, size_t part) const {
    return types[type]->parts()[part].volume.value_or(volume);
  }
};

/// Number of tests of the part boxes of two bodies.
uint64_t box_tests(const MidPhaseFrame& frame, const BodyPair& pair);

class PartCandidates {
 public:
  /// Runs a task: begin() with the posed bodies, add() for pairs of their slots, find(). Candidates
  /// are boxes within `margin_m` along every axis. `inner`: flag per pair or empty, see is_inner().
  void begin(const MidPhaseFrame& frame, const PosedBodies& bodies, float margin_m = 0);
  void add(const MidPhaseFrame& frame, std::span<const SlotPair> pairs,
           std::span<const uint8_t> inner = {});
  void find(const MidPhaseFrame& frame);

  /// Pairs of bodies, and pairs of parts, with boxes within the margin, in the order of add().
  std::span<const BodyPair> pairs() const { return {pairs_.data(), pair_count_}; }
  std::span<const Candidate> candidates() const { return {candidates_.data(), candidate_count_}; }
  PairKey key_of(const Candidate& candidate) const;
  /// True if the boxes overlap without a margin.
  bool boxes_overlap(const MidPhaseFrame& frame, const Candidate& candidate) const {
    return boxes_are_within(frame, candidate, 0);
  }
  /// True if a search with `inner_m` instead of margin_m would list the candidate.
  bool is_inner(const MidPhaseFrame& frame, const Candidate& candidate, float inner_m) const {
    return inner_[candidate.pair] != 0 && boxes_are_within(frame, candidate, inner_m);
  }
  /// Keeps the first `count` only.
  void keep_pairs(const MidPhaseFrame& frame, size_t count);
  void keep_candidates(size_t count) { candidate_count_ = count; }

  /// Calls test(shape a, shape b, candidates) for each bucket that is not empty, and
  /// rest(candidate) for each candidate of shapes without buckets. Candidates are indices.
  template <typename Test, typename Rest>
  void for_each_bucket(const Test& test, const Rest& rest);

  struct Counters {
    StageCounters body_box, part_box;
  };
  const Counters& counters() const { return counters_; }
  void clear_counters() { counters_ = {}; }
  void reserve_like(const PartCandidates& other);
  uint32_t times_grown() const;

 private:
  bool boxes_are_within(const MidPhaseFrame& frame, const Candidate& candidate,
                        float margin_m) const;
  void drop_filtered(const PairFilter& filter);
  void sort_into_buckets();

  const PosedBodies* bodies_ = nullptr;
  BoxFrame boxes_{};
  GrowBuffer<BodyPair> pairs_;
  GrowBuffer<uint8_t> inner_;  // by pair, if add() has flags
  GrowBuffer<Candidate> candidates_;
  GrowBuffer<uint32_t> bucket_start_, order_;
  size_t pair_count_ = 0, candidate_count_ = 0;
  Counters counters_;
};

template <typename Test, typename Rest>
void PartCandidates::for_each_bucket(const Test& test, const Rest& rest) {
  sort_into_buckets();
  const uint32_t shapes = boxes_.shapes;
  for (size_t a = 0; a < shapes; ++a) {
    for (size_t b = a; b < shapes; ++b) {
      const size_t bucket = a * shapes + b;
      const uint32_t begin = bucket_start_[bucket], count = bucket_start_[bucket + 1] - begin;
      if (count > 0) test(a, b, std::span(order_.data() + begin, count));
    }
  }
  for (uint32_t i = bucket_start_[bucket_count(shapes) - 1]; i < candidate_count_; ++i)
    rest(order_[i]);
}

}  // namespace throng
