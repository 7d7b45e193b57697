// Begin / persist / end: a frame's pairs against the last frame's.
// One rule: both come sorted, so a walk over both is all it takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/memory.h"
#include "culling/pair.h"

namespace throng {

/// Merges each frame's sorted pairs with the last frame's. The pairs of a frame come in blocks,
/// each written and compared by one thread, so that it is compared while it is still in the cache.
class PairEvents {
 public:
  /// Events have this level, unless events_to_level() is used to give them others.
  explicit PairEvents(PairLevel level = PairLevel::kPartVolume) : level_(level) {}

  /// Begins a frame of `count` pairs in `blocks` blocks.
  void begin(size_t count, size_t blocks);
  /// Where the caller writes the pairs of this frame, sorted and unique.
  PairKey* incoming() { return incoming_.data(); }
  /// Compares the incoming pairs [first, end) with the last frame's; both of the keys from `low`
  /// on, less than `high`. Blocks may come on any thread in any order.
  void compare(size_t block, size_t first, size_t end, PairKey low, PairKey high);
  /// When every block has been compared.
  void finish();
  /// All three for pairs that lie elsewhere; order asserted.
  void advance(std::span<const PairKey> pairs);
  /// Goes on behind a frame in which these touched; sorted and unique (asserted).
  void resume(std::span<const PairKey> touching);

  /// Begins and ends of this frame, sorted.
  std::span<const PairEvent> events() const { return {events_.data(), event_count_}; }
  /// For whoever knows a level of each event.
  std::span<PairEvent> events_to_level() { return {events_.data(), event_count_}; }
  std::span<const PairKey> touching() const { return {touching_.data(), touching_count_}; }
  uint64_t persisting() const { return persisting_; }  ///< pairs in this frame and in the last
  uint32_t times_grown() const;

 private:
  /// The events of a block: at the worst all its old pairs end and all its new ones begin, so there
  /// is room for them behind as many events as there are pairs before it.
  struct Block {
    size_t first = 0, events = 0;
    uint64_t persisting = 0;
  };

  PairLevel level_;
  GrowBuffer<PairKey> touching_, incoming_;
  GrowBuffer<PairEvent> events_;
  GrowBuffer<Block> blocks_;
  size_t block_count_ = 0;
  size_t touching_count_ = 0, incoming_count_ = 0;
  size_t event_count_ = 0;
  uint64_t persisting_ = 0;
};

}  // namespace throng
