// Kdop is the k-DOP along k/2 world directions, refitted when a part rotates.
// Invariant: place() and refit() both contain every point.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/pose.h"
#include "culling/volumes/slabs.h"

namespace throng {

template <int K>
struct Kdop {
  static_assert(K == 14 || K == 18 || K == 26);
  using Fitted = Slabs;  ///< in the part's frame
  using Placed = Slabs;  ///< along the world directions; only those of this k-DOP are set

  static Fitted fit(std::span<const Eigen::Vector3f> points) { return Slabs::around(points); }
  /// Refits to the rotated volume: conic bound along each world direction.
  static Placed place(const Fitted& fitted, const PartPose& pose, float scale);
  /// Refits to the placed vertices (Klosowski et al. 1998): tighter and more expensive.
  static Placed refit(std::span<const Eigen::Vector3f> points, const PartPose& pose, float scale);
  /// Tests k/2 intervals.
  static bool overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                       float margin_m);
  static double volume_m3(const Fitted& fitted);
};

extern template struct Kdop<14>;
extern template struct Kdop<18>;
extern template struct Kdop<26>;

}  // namespace throng
