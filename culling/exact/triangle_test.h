// Whether two triangles touch: the last word on a contact.
// One rule: closed sets, and doubt counts as touching - only a gap above the rounding separates.
#pragma once

#include <Eigen/Core>
#include <array>

namespace throng {

/// Corners in any frame that both triangles share. May be degenerate: a segment or a point.
struct Triangle {
  std::array<Eigen::Vector3d, 3> corner;
};

/// True if the closed triangles have a point in common. A gap below about 1e-13 of the largest
/// coordinate counts as touching (more for slivers, by as much as their normals are uncertain).
bool triangles_touch(const Triangle& a, const Triangle& b);

}  // namespace throng
