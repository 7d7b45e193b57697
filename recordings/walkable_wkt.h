// The walkable area of a recording as polygons: from well-known text (WKT), as simulators write it.
// One rule: read here and nowhere else; what is no polygon is refused in words.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

struct AreaPolygon {
  using Ring = std::vector<Eigen::Vector2d>;  ///< not closed: the last vertex is not the first
  Ring outline;
  std::vector<Ring> holes;
};

/// Twice the area of a ring; above 0 if it runs counter-clockwise.
double doubled_area(const AreaPolygon::Ring& ring);

/// POLYGON, MULTIPOLYGON and GEOMETRYCOLLECTION of these, in their own units; heights are left out.
/// Throws InputError that begins with `where`.
std::vector<AreaPolygon> parse_area(std::string_view wkt, const std::string& where);

/// Tells quickly whether a point lies in one of many polygons, or within a millimetre of an edge.
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
  std::vector<Edge> edges_;           ///< slab by slab, polygon by polygon
  std::vector<uint32_t> slab_begin_;  ///< of a slab's edges, and one more
};

}  // namespace throng
