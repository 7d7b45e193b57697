// PairKey identifies a pair of parts; PairEvent is the begin or the end of a contact of the pair.
// Invariant: pairs and events are unique and sorted by (body a, body b, part a, part b); body a is
// less than body b.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

#include "base/files/archive.h"

namespace throng {

/// Part index that stands for a whole body, in pairs that were not refined to parts.
inline constexpr uint32_t kWholeBody = 255;

/// Part `part_a` of body `a` and part `part_b` of body `b`, in 64 bits: a, b, part_a, part_b from
/// the highest bit. Body ids are 0 to kMaxId, parts 0 to 254 or kWholeBody.
class PairKey {
 public:
  static constexpr uint32_t kMaxId = (1u << 24) - 1;

  PairKey() = default;
  PairKey(uint32_t a, uint32_t b, uint32_t part_a, uint32_t part_b)
      : bits_((uint64_t{a} << 40) | (uint64_t{b} << 16) | parts_of(part_a, part_b)) {}
  /// Low 16 bits of a key, which identify the parts.
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
  /// Key that sorts after those of all pairs.
  static PairKey beyond_all() { return {kMaxId, kMaxId, 0xff, 0xff}; }
  /// Key of the same bodies with parts from parts_of(). This key's parts must be 0.
  PairKey with_parts(uint16_t parts) const {
    PairKey out;
    out.bits_ = bits_ | parts;
    return out;
  }

 private:
  uint64_t bits_ = 0;
};

/// Last test that a pair passed. Without a budget it is always the last enabled test. With one,
/// undecided pairs have the level that they reached.
enum class PairLevel : uint8_t {
  kSphere = 0,      ///< spheres of the two bodies
  kBox = 1,         ///< boxes of the posed bodies, or of the parts
  kPartVolume = 2,  ///< part volumes
  kTriangles = 3
};
inline constexpr size_t kPairLevels = 4;

/// Whether a contact begins in this frame, or was there in the last frame and is no longer.
enum class EventKind : uint8_t { kBegin = 0, kEnd = 1 };

struct PairEvent {
  PairKey pair;
  EventKind kind = EventKind::kBegin;
  PairLevel level = PairLevel::kPartVolume;  ///< at an end: that of the contact's last frame
  bool operator==(const PairEvent&) const = default;
};
static_assert(sizeof(PairEvent) == 16);

}  // namespace throng
