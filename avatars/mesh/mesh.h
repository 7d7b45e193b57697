// A triangle mesh, or a point cloud when it has no triangles.
// One rule: every index is in range and every coordinate finite; readers guarantee it.
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

/// Every edge is shared by exactly two triangles that run through it in opposite directions.
bool is_closed(const Mesh& mesh);

/// Signed volume in m3; positive when a closed mesh is oriented outwards.
double signed_volume_m3(const Mesh& mesh);

}  // namespace throng
