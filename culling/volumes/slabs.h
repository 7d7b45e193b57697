// Slabs stores the interval of a point set along each of the k/2 directions of a k-DOP.
// Invariant: bound() is never below the true support, so that separated volumes are apart.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

namespace throng {

/// The 13 unnormalised directions of the 26-DOP: axes, edges, corners (Klosowski et al. 1998).
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
    {{1, 0, -1}},  // edges: without x, without y,
    {{1, 1, 0}},
    {{1, -1, 0}},  // without z
    {{1, 1, 1}},
    {{1, 1, -1}},
    {{1, -1, 1}},
    {{1, -1, -1}},  // corners
}};

/// Directions of a k-DOP: 14 = axes and corners, 18 = axes and edges, 26 = all.
constexpr bool has_direction(int k, int direction) {
  if (direction < kAxisDirections) return true;
  const bool is_edge = direction < kAxisDirections + kEdgeDirections;
  return k == 26 || (k == 18 && is_edge) || (k == 14 && !is_edge);
}

/// Indices into kDirections. Edges: without the axis `omitted`, components of equal or opposite
/// sign. Corners: y or z with the sign opposite to x.
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

/// Slabs of a point set along all 13 directions; a k-DOP uses its own subset.
struct Slabs {
  std::array<Slab, 13> slab;

  /// Tightest slabs around the points (at least one), half widths rounded up.
  static Slabs around(std::span<const Eigen::Vector3f> points);

  /// Interval of the projections of all points on `d` (any length), by the conic bound of the
  /// k-DOP. With |d| sorted max >= mid >= min, d is a sum of a corner, an edge and an axis
  /// direction. The weights are min, mid - min and max - mid. Support functions are subadditive.
  template <int K>
  Slab bound(const Eigen::Vector3f& d) const;
};

template <>
Slab Slabs::bound<14>(const Eigen::Vector3f& d) const;
template <>
Slab Slabs::bound<18>(const Eigen::Vector3f& d) const;
template <>
Slab Slabs::bound<26>(const Eigen::Vector3f& d) const;

// Directions of the k-DOPs as floats, with bounds of their lengths. They are not normalised, so
// that a projection needs no products.

/// Lengths of the edge and corner directions, rounded up.
inline constexpr float kEdgeLength = 1.4142137f;
inline constexpr float kCornerLength = 1.7320509f;
static_assert(static_cast<double>(kEdgeLength) * static_cast<double>(kEdgeLength) > 2);
static_assert(static_cast<double>(kCornerLength) * static_cast<double>(kCornerLength) > 3);

constexpr float direction_length(int direction) {
  if (direction < kAxisDirections) return 1.0f;
  return direction < kAxisDirections + kEdgeDirections ? kEdgeLength : kCornerLength;
}

inline Eigen::Vector3f direction_vector(int direction) {
  const std::array<int, 3>& n = kDirections[static_cast<size_t>(direction)];
  return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
}

/// n . v, summed x, y, z from left to right. The factors are -1, 0 and 1, so no product rounds.
inline float along(const Eigen::Vector3f& n, const Eigen::Vector3f& v) {
  return n.x() * v.x() + n.y() * v.y() + n.z() * v.z();
}

}  // namespace throng
