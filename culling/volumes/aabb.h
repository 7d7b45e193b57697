// Aabb is the box along the world axes.
// Invariant: place() and refit() both contain every point.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/pose.h"

namespace throng {

struct Aabb {
  struct Fitted {
    Eigen::Vector3f centre_m;
    Eigen::Vector3f half_m;
  };
  using Placed = Fitted;

  static Fitted fit(std::span<const Eigen::Vector3f> points);
  /// Box of the rotated box (Arvo 1990): 9 products, independent of the number of vertices.
  static Placed place(const Fitted& fitted, const PartPose& pose, float scale);
  /// Box of the placed vertices: tighter, at a cost proportional to the number of vertices.
  static Placed refit(std::span<const Eigen::Vector3f> points, const PartPose& pose, float scale);
  static bool overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                       float margin_m);
  static double volume_m3(const Fitted& fitted);
};

}  // namespace throng
