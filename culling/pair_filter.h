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
  static constexpr bool meet(Sides a, Sides b) {
    constexpr Sides kLeft = 0x55555555;
    const Sides other_sides = (b & kLeft) << 1 | (b >> 1 & kLeft);
    return (a & other_sides) != 0;
  }

  /// By id; beyond the end: no side. Empty: every pair of bodies is asked for.
  std::vector<Sides> of_body;
  /// By type, by part. Empty: every pair of parts.
  std::vector<std::vector<Sides>> of_part;

  bool asks_bodies(uint32_t a, uint32_t b) const {
    if (of_body.empty()) return true;
    return a < of_body.size() && b < of_body.size() && meet(of_body[a], of_body[b]);
  }
  bool asks_parts(size_t type_a, size_t part_a, size_t type_b, size_t part_b) const {
    return of_part.empty() || meet(of_part[type_a][part_a], of_part[type_b][part_b]);
  }
  bool is_empty() const { return of_body.empty() && of_part.empty(); }
};

}  // namespace throng
