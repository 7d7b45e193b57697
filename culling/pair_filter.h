// PairFilter selects pairs of bodies and of parts.
// Invariant: selected pairs are reported as without a filter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace throng {

/// Each rule selects pairs with one member on its left side and one on its right. Members of both
/// sides are also selected with each other.
struct PairFilter {
  /// Two bits per rule: bit 2 i for the left side of rule i, bit 2 i + 1 for its right side.
  using Sides = uint32_t;
  static constexpr int kMaxRules = 16;
  static constexpr Sides left_of(int rule) { return Sides{1} << (2 * rule); }
  static constexpr Sides right_of(int rule) { return Sides{2} << (2 * rule); }
  /// True if a rule has `a` on one side and `b` on the other.
  static constexpr bool match(Sides a, Sides b) {
    constexpr Sides kLeft = 0x55555555;
    const Sides other_sides = (b & kLeft) << 1 | (b >> 1 & kLeft);
    return (a & other_sides) != 0;
  }

  /// Sides by body id; none beyond the end. Empty: all pairs of bodies are selected.
  std::vector<Sides> sides_of_body;
  /// Sides by type and part. Empty: all pairs of parts are selected.
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
