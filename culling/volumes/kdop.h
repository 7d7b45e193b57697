// The k-DOP with world directions: intervals along k/2 fixed directions, refitted when a part
// turns. One rule: both ways to update it, from the turned volume and from the vertices, contain
// every point.
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
  using Placed = Slabs;  ///< along the world's directions; only those that the K-DOP has are set

  static Fitted fit(std::span<const Eigen::Vector3f> points) { return Slabs::around(points); }
  /// Refitted to the turned volume: the conic bound along each of the world's directions.
  static Placed place(const Fitted& fitted, const PartPose& pose, float scale);
  /// Refitted to the placed vertices (Klosowski et al. 1998): tighter and dearer.
  static Placed refit(std::span<const Eigen::Vector3f> points, const PartPose& pose, float scale);
  /// k/2 interval tests.
  static bool overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                       float margin_m);
  static double volume_m3(const Fitted& fitted);
};

extern template struct Kdop<14>;
extern template struct Kdop<18>;
extern template struct Kdop<26>;

}  // namespace throng
