// The floor of a plan is its walkable area as polygons. Strips line its edges on the outside, as
// walls that agents cannot cross.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/polygon.h"

namespace throng {

/// A convex quadrilateral along an edge of the floor, on the side that is not walkable,
/// counter-clockwise.
using FloorStrip = std::array<Eigen::Vector2d, 4>;

/// Thickness of strips, less where the floor continues behind a thinner wall.
inline constexpr double kStripThickness_m = 0.05;

/// Returns a strip for each edge of at least 0.1 mm. Strips meet at the corners and do not reach
/// into the floor by more than 1 mm.
std::vector<FloorStrip> strips_around(const std::vector<Polygon>& floor);

/// Returns where a line along x enters and leaves the floor, in ascending order.
std::vector<double> crossings_m(const std::vector<Polygon>& floor, double y_m);

}  // namespace throng
