// Pairs of parts that overlap, and their begin / persist / end.
// One rule: pairs and events leave sorted by (body a, body b, part a, part b), a < b, none twice.
#pragma once

#include <compare>
#include <cstdint>
#include <span>

#include "base/files/archive.h"
#include "base/grow_buffer.h"

namespace throng {

/// Part `part_a` of body `a` overlaps part `part_b` of body `b`; a < b. 64 bits, ordered as
/// written.
class PairKey {
 public:
  static constexpr uint32_t kMaxId = (1u << 24) - 1;

  PairKey() = default;
  PairKey(uint32_t a, uint32_t b, uint32_t part_a, uint32_t part_b)
      : bits_((uint64_t{a} << 40) | (uint64_t{b} << 16) | parts_of(part_a, part_b)) {}
  /// The low bits, which name the parts.
  static constexpr uint32_t parts_of(uint32_t part_a, uint32_t part_b) {
    return (part_a << 8) | part_b;
  }

  uint32_t a() const { return static_cast<uint32_t>(bits_ >> 40); }
  uint32_t b() const { return static_cast<uint32_t>(bits_ >> 16) & kMaxId; }
  uint32_t part_a() const { return static_cast<uint32_t>(bits_ >> 8) & 0xff; }
  uint32_t part_b() const { return static_cast<uint32_t>(bits_) & 0xff; }
  uint64_t bits() const { return bits_; }
  void archive(Archive& a) { a(bits_); }
  auto operator<=>(const PairKey&) const = default;
  /// Greater than every key of two bodies.
  static PairKey beyond_all() { return {kMaxId, kMaxId, 0xff, 0xff}; }
  /// The same bodies with parts, see parts_of(); has parts 0.
  PairKey with_parts(uint16_t parts) const {
    PairKey out;
    out.bits_ = bits_ | parts;
    return out;
  }

 private:
  uint64_t bits_ = 0;
};

enum class EventKind : uint8_t { kBegin = 0, kEnd = 1 };

struct PairEvent {
  PairKey pair;
  EventKind kind;
  bool operator==(const PairEvent&) const = default;
};

/// Merges each frame's sorted pairs with the last frame's. The pairs of a frame come in blocks,
/// each written and compared by one thread, so that it is compared while it is still in the cache.
class PairEvents {
 public:
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

  GrowBuffer<PairKey> touching_, incoming_;
  GrowBuffer<PairEvent> events_;
  GrowBuffer<Block> blocks_;
  size_t block_count_ = 0;
  size_t touching_count_ = 0, incoming_count_ = 0;
  size_t event_count_ = 0;
  uint64_t persisting_ = 0;
};

}  // namespace throng
