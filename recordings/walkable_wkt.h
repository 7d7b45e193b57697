// WKT parsing reads the walkable area of a recording from well-known text. Geometries other than
// polygons are rejected.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

struct AreaPolygon {
  using Ring = std::vector<Eigen::Vector2d>;  ///< the first vertex is not repeated
  Ring outline;
  std::vector<Ring> holes;
};

/// Twice the signed area of a ring; positive if counter-clockwise.
double doubled_area(const AreaPolygon::Ring& ring);

/// Parses POLYGON, MULTIPOLYGON and GEOMETRYCOLLECTION of these, in their own units; z is ignored.
/// Throws InputError at `where`.
std::vector<AreaPolygon> parse_area(std::string_view wkt, const std::string& where);

/// WalkableArea tests quickly whether a point lies in one of many polygons, or within 1 mm of an
/// edge.
class WalkableArea {
 public:
  explicit WalkableArea(const std::vector<AreaPolygon>& polygons);
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
