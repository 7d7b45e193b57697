// PairEvents compares the pairs of a frame with those of the last frame. Events are sorted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/memory.h"
#include "culling/pair.h"

namespace throng {

/// Merges each frame's sorted pairs with the last frame's. Pairs come in blocks. One thread writes
/// and compares a block while it is in the cache.
class PairEvents {
 public:
  /// `level`: level of all events that events_to_level() does not change.
  explicit PairEvents(PairLevel level = PairLevel::kPartVolume) : level_(level) {}

  /// Begins a frame of `count` pairs in `blocks` blocks.
  void begin(size_t count, size_t blocks);
  /// Buffer for the pairs of this frame. The caller writes them sorted and unique.
  PairKey* incoming() { return incoming_.data(); }
  /// Compares the incoming pairs [first, end) with those of the last frame with keys in [low,
  /// high). Different blocks may run on any threads in any order.
  void compare(size_t block, size_t first, size_t end, PairKey low, PairKey high);
  /// Completes the frame after all blocks have been compared.
  void finish();
  /// Runs all three steps for pairs in the caller's memory; order asserted.
  void advance(std::span<const PairKey> pairs);
  /// Continues from a frame with these pairs; sorted and unique (asserted).
  void resume(std::span<const PairKey> touching);

  /// Begin and end events of this frame, sorted.
  std::span<const PairEvent> events() const { return {events_.data(), event_count_}; }
  /// Events, for callers that set their levels.
  std::span<PairEvent> events_to_level() { return {events_.data(), event_count_}; }
  std::span<const PairKey> touching() const { return {touching_.data(), touching_count_}; }
  /// number of pairs in this frame and in the last
  uint64_t persisting() const { return persisting_; }
  uint32_t times_grown() const;

 private:
  /// Events of a block. In the worst case all its old pairs end and all new ones begin. Its events
  /// therefore start behind as many elements as the earlier blocks have old and new pairs.
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
