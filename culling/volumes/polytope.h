// Polytope is the solid that slabs enclose, with its corners, for construction and reports.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "culling/volumes/slabs.h"

namespace throng {

struct Polytope {
  std::vector<Eigen::Vector3d> corners_m;  ///< face by face; shared corners repeat
  std::vector<size_t> face_ends;  ///< end of each face in corners_m; corners turn around the normal
  double volume_m3 = 0;
};

/// Intersection of the slabs of the k-DOP, face by face. Flat slabs give volume zero.
Polytope polytope_of(const Slabs& slabs, int k);

}  // namespace throng
