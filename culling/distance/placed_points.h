// A hull's corners and points where they are, in a frame that two parts share.
// One rule: placed as the floats of the pose have it, in double precision.
#pragma once

#include <Eigen/Geometry>

#include "culling/distance/hull_depth.h"

namespace throng {

struct PlacedPoints {
  explicit PlacedPoints(const PlacedHull& placed,
                        const Eigen::Vector3d& root_m = Eigen::Vector3d::Zero())
      : hull(*placed.hull) {
    const Eigen::Isometry3d pose = to_isometry(*placed.pose);
    scale = static_cast<double>(placed.scale);
    linear = scale * pose.linear();
    shift = pose.translation() + root_m;
  }
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const {
    return linear * hull.support(linear.transpose() * direction) + shift;
  }
  double extent(const Eigen::Vector3d& direction) const {
    return hull.extent(linear.transpose() * direction) + direction.dot(shift);
  }
  /// How far from where the part's origin is placed the farthest point is, but for rounding.
  double reach_m() const { return scale * hull.reach_m(); }
  /// By how much at most a point reaches beyond support(), along any unit direction.
  double beyond_support_m() const { return scale * hull.beyond_corners_m(); }

  const ConvexHull& hull;
  double scale;
  Eigen::Matrix3d linear;
  Eigen::Vector3d shift;
};

}  // namespace throng
