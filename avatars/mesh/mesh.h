// Mesh is a triangle mesh, or a point cloud if it has no triangles.
// Invariant: every index is in range and every coordinate finite; readers guarantee it.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace throng {

struct Mesh {
  std::vector<Eigen::Vector3f> vertices;  ///< metres
  std::vector<Eigen::Vector3i>
      triangles;  ///< counter-clockwise seen from outside; empty: a point cloud

  bool is_point_cloud() const { return triangles.empty(); }
};

/// Whether every edge is shared by exactly two triangles, in opposite directions.
bool is_closed(const Mesh& mesh);

/// Returns the signed volume in m3; positive for a closed mesh oriented outwards.
double signed_volume_m3(const Mesh& mesh);

}  // namespace throng
