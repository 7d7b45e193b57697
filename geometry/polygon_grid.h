// Area grid rounds polygons to 0.1 mm, on which unions and differences are exact.
#pragma once

#include <Eigen/Core>
#include <boost/polygon/polygon.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/polygon.h"

namespace throng {

/// Grid spacing. Integer coordinates make polygon operations exact.
inline constexpr double kAreaUnit_m = 1e-4;
/// Maximum distance of grid polygons from the origin; 32-bit integers hold twice as much.
inline constexpr double kMaxOnGrid_m = 1e5;

using GridPoint = boost::polygon::point_data<int>;
using GridSet = boost::polygon::polygon_set_data<int>;
using GridShape = boost::polygon::polygon_with_holes_data<int>;

/// @pre No coordinate is beyond kMaxOnGrid_m.
inline GridPoint grid_point(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::lround(p.x() / kAreaUnit_m)),
          static_cast<int>(std::lround(p.y() / kAreaUnit_m))};
}

inline Eigen::Vector2d metres(const GridPoint& point) {
  return {kAreaUnit_m * point.x(), kAreaUnit_m * point.y()};
}

inline boost::polygon::polygon_data<int> grid_polygon(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<GridPoint> points;
  for (const Eigen::Vector2d& corner : corners) points.push_back(grid_point(corner));
  boost::polygon::polygon_data<int> polygon;
  polygon.set(points.begin(), points.end());
  return polygon;
}

inline void add_to(GridSet& set, const GridSet& other) {
  std::vector<GridShape> shapes;
  other.get(shapes);
  for (const GridShape& shape : shapes) set.insert(shape);
}

inline GridSet grid_set(const Polygon::Ring& ring) {
  GridSet left, right, both;
  left.insert(grid_polygon(ring));
  right.insert(grid_polygon(ring), true);
  add_to(both, left);
  add_to(both, right);
  return both;
}

/// All holes together: subtracting each of a thousand holes would take a thousand times as long.
inline GridSet grid_set_of_holes(const Polygon& polygon) {
  GridSet holes;
  for (const Polygon::Ring& hole : polygon.holes) add_to(holes, grid_set(hole));
  return holes;
}

/// Shapes as polygons in metres, without repeated vertices.
inline std::vector<Polygon> polygons_of(const std::vector<GridShape>& shapes) {
  const auto ring_of = [](const auto& points) {
    Polygon::Ring ring;
    for (const GridPoint& point : points)
      if (ring.empty() || ring.back() != metres(point)) ring.push_back(metres(point));
    while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    return ring;
  };
  std::vector<Polygon> out;
  for (const GridShape& shape : shapes) {
    Polygon polygon{ring_of(shape), {}};
    if (polygon.outline.size() < 3) continue;
    for (auto hole = shape.begin_holes(); hole != shape.end_holes(); ++hole)
      if (Polygon::Ring ring = ring_of(*hole); ring.size() >= 3)
        polygon.holes.push_back(std::move(ring));
    out.push_back(std::move(polygon));
  }
  return out;
}

inline GridSet grid_set(const Polygon& polygon) {
  using namespace boost::polygon::operators;
  return GridSet(grid_set(polygon.outline) - grid_set_of_holes(polygon));
}

}  // namespace throng
