// How far apart two triangles are, and where they are nearest.
// One rule: both bounds are proven: a pair of points of theirs, and a direction along which they
// lie apart.
#pragma once

#include "culling/triangles/triangle_test.h"

namespace throng {

struct TriangleGap {
  NearestPoints points;  ///< one of each triangle
  double hi = 0;         ///< their distance
  double lo = 0;         ///< the gap along the line through them, at least 0; hi but for rounding
};

/// How far a triangle lies along a direction.
double min_along(const Eigen::Vector3d& axis, const Triangle& t);
double max_along(const Eigen::Vector3d& axis, const Triangle& t);

/// Along any direction the gap proves a distance: 0 where the triangles overlap along it.
double gap_along(const Eigen::Vector3d& unit, const Triangle& a, const Triangle& b);

/// Of triangles that do not touch: those that do have lo 0. May be degenerate: a segment or a
/// point.
TriangleGap triangle_gap(const Triangle& a, const Triangle& b);

}  // namespace throng
