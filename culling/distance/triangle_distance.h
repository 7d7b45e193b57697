// triangle_gap() computes the distance between two triangles and their nearest points.
// Invariant: both bounds are proven, by a pair of points and by a gap along a direction.
#pragma once

#include "culling/triangles/triangle_test.h"

namespace throng {

struct TriangleGap {
  NearestPoints points;  ///< one of each triangle
  double hi = 0;         ///< distance of the points
  /// gap along the line through the points, at least 0; equals hi except for rounding
  double lo = 0;
};

/// Extent of a triangle along a direction.
double min_along(const Eigen::Vector3d& axis, const Triangle& t);
double max_along(const Eigen::Vector3d& axis, const Triangle& t);

/// Gap along a unit direction, a lower bound of the distance: 0 if the triangles overlap along it.
double gap_along(const Eigen::Vector3d& unit, const Triangle& a, const Triangle& b);

/// Distance of triangles that do not touch (lo is 0 if they do). Segments and points are valid.
TriangleGap triangle_gap(const Triangle& a, const Triangle& b);

}  // namespace throng
