// The order in which a deadline lets pairs of bodies be refined: who touched in the last frame
// first, then whose spheres overlap deepest.
// One rule: what is taken depends on the pairs alone, not on the order in which they were found.
#pragma once

#include <cstdint>
#include <span>

#include "base/grow_buffer.h"
#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/kernels/kernels.h"
#include "culling/pair.h"
#include "culling/stages/broad_phase.h"
#include "culling/stages/slots.h"

namespace throng {

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

  /// The next pairs, at least `wanted` if there are as many, cut only where the order between them
  /// does not matter: for who refines all of them.
  std::span<const UrgentPair> peek(size_t wanted) const;
  /// Brings the next `wanted` pairs into their exact order.
  void sort_next(size_t wanted, const Slots& slots);
  /// The next `wanted` pairs, in exact order as far as sort_next() went.
  std::span<const UrgentPair> peek_sorted(size_t wanted) const;
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

}  // namespace throng
