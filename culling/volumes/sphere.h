// Sphere is the bounding sphere: rotation changes only its centre.
// Invariant: a fitted sphere contains every point; its radius is rounded up.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/pose.h"

namespace throng {

struct Sphere {
  struct Fitted {
    Eigen::Vector3f centre_m;
    float radius_m;
  };
  using Placed = Fitted;

  /// Smallest enclosing sphere (Welzl 1991, move to front) of at least one point.
  static Fitted fit(std::span<const Eigen::Vector3f> points);
  static Placed place(const Fitted& fitted, const PartPose& pose, float scale);
  static bool overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                       float margin_m);
  static double volume_m3(const Fitted& fitted);
};

}  // namespace throng
