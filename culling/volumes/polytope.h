// The solid that slabs enclose, with its corners: what volumes are measured with.
// One rule: for construction, reports and tests; nothing of it runs in a frame.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "culling/volumes/slabs.h"

namespace throng {

struct Polytope {
  std::vector<Eigen::Vector3d> corners_m;  ///< face by face; shared corners repeat
  std::vector<size_t> face_ends;  ///< of each face in corners_m; they turn about the normal
  double volume_m3 = 0;
};

/// The intersection of the slabs of the k-DOP, face by face. Flat slabs give volume zero.
Polytope polytope_of(const Slabs& slabs, int k);

}  // namespace throng
