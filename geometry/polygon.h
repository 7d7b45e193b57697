// Polygon is an area of the ground with straight edges and holes, in metres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

/// Calls `visit(ring)` for the outline, then for each hole.
template <typename Visit>
void for_each_ring(const Polygon& polygon, const Visit& visit) {
  visit(polygon.outline);
  for (const Polygon::Ring& hole : polygon.holes) visit(hole);
}

/// Calls `visit(from, to)` for each edge of the polygons.
template <typename Visit>
void for_each_edge(std::span<const Polygon> polygons, const Visit& visit) {
  for (const Polygon& polygon : polygons)
    for_each_ring(polygon, [&](const Polygon::Ring& ring) {
      for (size_t i = 0; i < ring.size(); ++i) visit(ring[i], ring[(i + 1) % ring.size()]);
    });
}

/// x where an edge meets the line along x at `y_m`, if its ends lie on both sides of the line.
inline std::optional<double> crossing_m(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                        double y_m) {
  if ((from.y() > y_m) == (to.y() > y_m)) return std::nullopt;
  return from.x() + (y_m - from.y()) / (to.y() - from.y()) * (to.x() - from.x());
}

/// Returns whether a point lies in polygons that do not overlap; looks at all edges.
bool is_inside(std::span<const Polygon> polygons, const Eigen::Vector2d& point);

/// Part of a ring inside a rectangle; the ring is convex, or may get edges that lie on each other
/// (Sutherland and Hodgman 1974).
Polygon::Ring clipped_to(Polygon::Ring ring, const Rectangle& rectangle);

/// Maps all vertices by x -> fixed_m + factor * (x - fixed_m).
void scale(std::vector<Polygon>& polygons, const Eigen::Vector2d& fixed_m, double factor);

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

/// What mended() makes of a polygon.
struct MendedPolygon {
  std::vector<Polygon> polygons;      ///< without faults; none if there is a fault
  std::optional<PolygonFault> fault;  ///< that cannot be mended
  /// Holes and spikes of rings that enclose no area on the grid; they were dropped.
  int64_t slivers = 0;
  Eigen::Vector2d sliver_at_m = Eigen::Vector2d::Zero();  ///< one of them
};

/// Returns a polygon without a fault unchanged. Otherwise drops slivers, unites holes that overlap
/// or adjoin, and cuts off holes that adjoin the outline. Rings that cross themselves and holes
/// that cross the outline remain faults.
MendedPolygon mended(Polygon polygon);

/// "2 slivers without area left out, one near [1.0000, 2.0000]"; slivers: at least one.
std::string slivers_text(const MendedPolygon& polygon);

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
