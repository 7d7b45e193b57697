// A pair of parts that overlap, how far it was refined, and when it begins and ends.
// One rule: pairs and events leave sorted by (body a, body b, part a, part b), a < b, none twice.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

#include "base/files/archive.h"

namespace throng {

/// The part index, on both sides, of a pair of bodies that was not refined to parts.
inline constexpr uint32_t kWholeBody = 255;

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

/// What said last that the two may touch. Without a deadline every pair gets to the last stage
/// there is; under one, a pair that touches is still reported, at the level it reached.
enum class PairLevel : uint8_t {
  kSphere = 0,      ///< the spheres of the two bodies
  kBox = 1,         ///< boxes: of the bodies in their poses, or of the parts
  kPartVolume = 2,  ///< the part volume
  kTriangles = 3    ///< triangles
};
inline constexpr size_t kPairLevels = 4;

enum class EventKind : uint8_t { kBegin = 0, kEnd = 1 };

struct PairEvent {
  PairKey pair;
  EventKind kind = EventKind::kBegin;
  PairLevel level = PairLevel::kPartVolume;  ///< of an end: at which it was last reported
  bool operator==(const PairEvent&) const = default;
};
static_assert(sizeof(PairEvent) == 16);

}  // namespace throng
