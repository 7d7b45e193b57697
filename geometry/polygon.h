// Polygon is an area of the ground with straight edges and holes, in metres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/rectangle.h"

namespace throng {

struct Polygon {
  using Ring = std::vector<Eigen::Vector2d>;  ///< the first vertex is not repeated
  Ring outline;
  std::vector<Ring> holes;

  bool operator==(const Polygon&) const = default;
};

/// Maximum number of vertices of all polygons of a plan.
inline constexpr size_t kMaxVertices = 100'000;

/// z of the cross product: positive if `b` points to the left of `a`.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Twice the signed area of a ring; positive if counter-clockwise.
double doubled_area(const Polygon::Ring& ring);

/// Area of a polygon without its holes, which lie inside it.
double area_m2(const Polygon& polygon);

size_t vertex_count(const std::vector<Polygon>& polygons);

/// Smallest rectangle that contains all points, of which there is at least one.
Rectangle bounds_of(const std::vector<Eigen::Vector2d>& points);

/// Smallest rectangle that contains all polygons, of which there is at least one.
Rectangle bounds_of(const std::vector<Polygon>& polygons);

Polygon polygon_of(const Rectangle& rectangle);

/// Returns the rectangle that a polygon is, if it has four corners and edges along x and y.
std::optional<Rectangle> rectangle_of(const Polygon& polygon);

double distance_to_segment_m(const Eigen::Vector2d& point, const Eigen::Vector2d& from,
                             const Eigen::Vector2d& to);

/// Defect of a polygon and its place.
struct PolygonFault {
  std::string expected;  ///< "edges that do not cross"
  std::string found;     ///< "a crossing at [1, 2]"
};

/// Returns a defect on a grid of 0.1 mm. Vertices must be finite and within kMaxOnGrid_m of the
/// origin. Rings must have an area and may touch in points. Edges must neither cross nor overlap,
/// and holes must lie within the outline.
std::optional<PolygonFault> fault_of(const Polygon& polygon);

/// Triangles that cover a polygon without a fault; each has three vertices of it,
/// counter-clockwise.
using FlatTriangle = std::array<Eigen::Vector2d, 3>;
std::vector<FlatTriangle> triangles_of(const Polygon& polygon);

/// Convex rings that cover a polygon without a fault, counter-clockwise, made of its vertices
/// (Hertel and Mehlhorn 1983: at most four times the least number).
std::vector<Polygon::Ring> convex_pieces_of(const Polygon& polygon);

/// PolygonLocator tests quickly whether a point lies in one of many polygons, or within 1 mm of an
/// edge.
class PolygonLocator {
 public:
  explicit PolygonLocator(const std::vector<Polygon>& polygons);
  bool contains(const Eigen::Vector2d& point) const;

 private:
  struct Edge {
    Eigen::Vector2d from, to;
    uint32_t polygon;
  };
  size_t slab_of(double y) const;

  double bottom_ = 0, top_ = 0, slabs_per_m_ = 0;
  std::vector<Edge> edges_;           ///< sorted by slab, then by polygon
  std::vector<uint32_t> slab_begin_;  ///< first edge of each slab, and the end
};

}  // namespace throng
