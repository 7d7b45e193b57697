// How far apart the convex hulls of two parts are (Gilbert, Johnson & Keerthi, A fast procedure for
// computing the distance between complex objects, IEEE J. Robotics and Automation 4(2), 1988).
// One rule: the lower bound is proven by a gap along a direction, whether or not the search has
// converged.
#pragma once

#include <Eigen/Core>

#include "culling/distance/hull_depth.h"
#include "culling/exact/segments.h"

namespace throng {

struct HullGap {
  double lo_m = 0;     ///< no two points of the parts are nearer; 0: perhaps they overlap
  double about_m = 0;  ///< the distance of the hulls, found to 0.1 mm where it converged
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< along which lo_m is proven: unit,
                                                         ///< world axes, from A to B
  double corners_m = 0;  ///< the distance of two corners that were met: the parts are not farther
  NearestPoints points_m = {};  ///< of the hulls, at about_m; relative to A's root, in world axes
};

/// `direction`: unit, from A to B, to begin with. a_to_b_m is B's root minus A's, as in
/// solids_touch(). No allocation.
HullGap hull_gap(const PlacedHull& a, const PlacedHull& b, const Eigen::Vector3f& a_to_b_m,
                 const Eigen::Vector3d& direction);

}  // namespace throng
