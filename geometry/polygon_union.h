// JoinedArea is an area of several polygons after adjoining and overlapping ones are joined.
// Invariant: a polygon without a slit that neither adjoins nor overlaps another is bitwise
// unchanged.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/polygon.h"

namespace throng {

struct JoinedArea {
  std::vector<Polygon> polygons;
  /// Number of pairs of polygons with a closed gap wider than rounding; a polygon with a closed
  /// slit counts as a pair with itself.
  int64_t gaps = 0;
  double max_gap_m = 0;
  Eigen::Vector2d max_gap_at_m = Eigen::Vector2d::Zero();
};

/// Union of rings on the grid of 0.1 mm, as polygons that do not overlap. Rings without area are
/// ignored. Throws nothing.
/// @pre No coordinate is beyond 100 km.
std::vector<Polygon> united(const std::vector<Polygon::Ring>& rings);

/// Joins polygons in metres. Slits of up to 1 mm within a ring are closed like gaps between
/// polygons. A hole that is this narrow everywhere is an obstacle and stays. Corners keep their
/// coordinates. Crossings of edges become new corners, exact to 0.1 mm. Corners created by the cut
/// between two polygons are dropped if they lie within 1 mm of a straight line. Throws InputError
/// at `where` if adjoining polygons lie too far out or cross too often.
JoinedArea join(const std::vector<Polygon>& polygons, const std::string& where);

}  // namespace throng
