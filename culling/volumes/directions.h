// The 13 directions of the k-DOPs as floats, with bounds of their lengths.
// One rule: never normalised, so that projecting on one is adding and subtracting.
#pragma once

#include <Eigen/Core>
#include <array>

#include "culling/volumes/slabs.h"

namespace throng {

/// Lengths of the axis, edge and corner directions, rounded up.
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
