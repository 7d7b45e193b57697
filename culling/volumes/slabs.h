// The slabs of a k-DOP: for each of its k/2 directions the interval that the points cover.
// One rule: bound() is never below the true support, so that whatever it separates is apart.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

namespace throng {

/// The 13 directions of the 26-DOP, unnormalised: 3 axes, 6 edges, 4 corners (Klosowski et al.
/// 1998).
inline constexpr int kAxisDirections = 3;
inline constexpr int kEdgeDirections = 6;
inline constexpr int kCornerDirections = 4;
inline constexpr std::array<std::array<int, 3>, 13> kDirections = {{
    {{1, 0, 0}},
    {{0, 1, 0}},
    {{0, 0, 1}},  // axes
    {{0, 1, 1}},
    {{0, 1, -1}},
    {{1, 0, 1}},
    {{1, 0, -1}},  // edges; without x, without y,
    {{1, 1, 0}},
    {{1, -1, 0}},  // without z
    {{1, 1, 1}},
    {{1, 1, -1}},
    {{1, -1, 1}},
    {{1, -1, -1}},  // corners
}};

/// Which of the 13 directions a k-DOP has: 14 = axes and corners, 18 = axes and edges, 26 = all.
constexpr bool has_direction(int k, int direction) {
  if (direction < kAxisDirections) return true;
  const bool is_edge = direction < kAxisDirections + kEdgeDirections;
  return k == 26 || (k == 18 && is_edge) || (k == 14 && !is_edge);
}

/// The edge direction that leaves `omitted` out, for components of equal or opposite sign; and the
/// corner direction whose y or z has the sign opposite to x. Indices into kDirections.
constexpr size_t edge_direction(size_t omitted, bool opposite) {
  return kAxisDirections + 2 * omitted + (opposite ? 1 : 0);
}
constexpr size_t corner_direction(bool y_opposite, bool z_opposite) {
  return kAxisDirections + kEdgeDirections + (y_opposite ? 2u : 0u) + (z_opposite ? 1u : 0u);
}

/// Interval along a direction: [centre - half, centre + half].
struct Slab {
  float centre = 0;
  float half = 0;
};

/// The slabs of a point set along all 13 directions; a k-DOP uses the ones that it has.
struct Slabs {
  std::array<Slab, 13> slab;

  /// The tightest slabs around the points (at least one), half widths rounded up.
  static Slabs around(std::span<const Eigen::Vector3f> points);

  /// The interval that covers every point's projection on `d` (any length): conic bound from the
  /// slabs of the k-DOP. With |d| sorted max >= mid >= min, d is a sum of a corner, an edge and an
  /// axis direction with weights min, mid - min, max - mid, and support functions are subadditive.
  template <int K>
  Slab bound(const Eigen::Vector3f& d) const;
};

}  // namespace throng
