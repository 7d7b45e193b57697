// Which pairs are asked for: of bodies, and of parts.
// One rule: what is asked for is found as without a filter; the rest is dropped as early as can be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace throng {

/// A rule asks for the pairs of one on its left side and one on its right. Who or what stands on
/// both sides is asked for with its like.
struct PairFilter {
  /// Two bits a rule: 2 i for the left side of rule i, 2 i + 1 for its right side.
  using Sides = uint32_t;
  static constexpr int kMaxRules = 16;
  static constexpr Sides left_of(int rule) { return Sides{1} << (2 * rule); }
  static constexpr Sides right_of(int rule) { return Sides{2} << (2 * rule); }
  /// Some rule has one of them on its left and the other on its right.
  static constexpr bool match(Sides a, Sides b) {
    constexpr Sides kLeft = 0x55555555;
    const Sides other_sides = (b & kLeft) << 1 | (b >> 1 & kLeft);
    return (a & other_sides) != 0;
  }

  /// By id; beyond the end: no side. Empty: every pair of bodies is asked for.
  std::vector<Sides> sides_of_body;
  /// By type, by part. Empty: every pair of parts.
  std::vector<std::vector<Sides>> sides_of_part;

  bool includes_bodies(uint32_t a, uint32_t b) const {
    if (sides_of_body.empty()) return true;
    return a < sides_of_body.size() && b < sides_of_body.size() &&
           match(sides_of_body[a], sides_of_body[b]);
  }
  bool includes_parts(size_t type_a, size_t part_a, size_t type_b, size_t part_b) const {
    return sides_of_part.empty() ||
           match(sides_of_part[type_a][part_a], sides_of_part[type_b][part_b]);
  }
  bool is_empty() const { return sides_of_body.empty() && sides_of_part.empty(); }
};

}  // namespace throng
