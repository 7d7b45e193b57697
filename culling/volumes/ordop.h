// Ordop is the or-DOP (oriented k-DOP), a k-DOP fitted in the part's frame that rotates with it.
// Its update is a pose.
// Invariant: ordop_overlaps() is the reference; faster kernels repeat its operations bit for bit.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/pose.h"
#include "culling/volumes/slabs.h"

namespace throng {

/// Tests the face normals of both as separating axes (k/2 each). Along a face normal of one, its
/// own slab is exact; the other's interval is Slabs::bound<K>.
///   a_to_b_m  B's root position minus A's
///   margin_m  inflation of B; at least rounding_margin_m()
template <int K>
bool ordop_overlaps(const Slabs& slabs_a, const PartPose& pose_a, float scale_a,
                    const Slabs& slabs_b, const PartPose& pose_b, float scale_b,
                    const Eigen::Vector3f& a_to_b_m, float margin_m);

template <int K>
struct Ordop {
  static_assert(K == 14 || K == 18 || K == 26);
  using Fitted = Slabs;
  /// Refers to the fitted slabs, which must outlive it.
  struct Placed {
    const Slabs* slabs;
    PartPose pose;
    float scale;
  };

  static Fitted fit(std::span<const Eigen::Vector3f> points) { return Slabs::around(points); }
  static Placed place(const Fitted& fitted, const PartPose& pose, float scale) {
    return {&fitted, pose, scale};
  }
  static Placed place(Fitted&& fitted, const PartPose& pose, float scale) = delete;
  static bool overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                       float margin_m) {
    return ordop_overlaps<K>(*a.slabs, a.pose, a.scale, *b.slabs, b.pose, b.scale, a_to_b_m,
                             margin_m);
  }
  static double volume_m3(const Fitted& fitted);
};

}  // namespace throng
