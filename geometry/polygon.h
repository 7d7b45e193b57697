// Polygon is an area of the ground with straight edges and holes, in metres.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace throng {

struct Polygon {
  using Ring = std::vector<Eigen::Vector2d>;  ///< the first vertex is not repeated
  Ring outline;
  std::vector<Ring> holes;

  bool operator==(const Polygon&) const = default;
};

/// Twice the signed area of a ring; positive if counter-clockwise.
double doubled_area(const Polygon::Ring& ring);

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
