// The point of a surface that is nearest to another point.
// One rule: the point lies on a triangle, so its distance is never below the true one.
#pragma once

#include <Eigen/Core>

#include "culling/exact/triangle_bvh.h"

namespace throng {

struct SurfacePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double squared = 0;  ///< of its distance
};

/// In the part's own frame. No allocation.
SurfacePoint nearest_on_surface(const TriangleBvh& surface, const Eigen::Vector3d& to,
                                ExactCounters& counters);

}  // namespace throng
