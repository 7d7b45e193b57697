// Obb is the oriented box, fitted once in the part's frame; it rotates with the part.
// Invariant: an axis separates only by more than the margin, which covers near-parallel edges.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/pose.h"

namespace throng {

struct Obb {
  struct Fitted {
    Eigen::Vector3f centre_m;
    Eigen::Vector3f half_m;
    Eigen::Matrix3f axes;  ///< columns, unit length
  };
  using Placed = Fitted;

  /// Smallest box found from the principal axes and the frame's axes, refined by small rotations.
  static Fitted fit(std::span<const Eigen::Vector3f> points);
  static Placed place(const Fitted& fitted, const PartPose& pose, float scale);
  /// Tests 15 separating axes (Gottschalk, Lin, Manocha 1996).
  static bool overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                       float margin_m);
  static double volume_m3(const Fitted& fitted);
};

/// Axes (columns) chosen by the fit; exposed for tests.
Eigen::Matrix3d smallest_box_axes(std::span<const Eigen::Vector3f> points);

}  // namespace throng
