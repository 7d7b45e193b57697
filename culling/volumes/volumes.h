// BoundingVolume is the concept of all bounding volumes; volume_list.h lists them.
// Invariant: overlaps() == false proves that the enclosed points are apart; true means "maybe".
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <span>

#include "base/pose.h"

namespace throng {

/// A volume is fitted once to a part's points, in the part's frame. It is placed when the part has
/// moved (the paper's update, C_u) and tested pair by pair (the paper's test, C_v). Poses are
/// relative to each body's own root. A test therefore takes `a_to_b_m`, B's root minus A's,
/// computed in double and rounded once.
template <typename V>
concept BoundingVolume = requires(std::span<const Eigen::Vector3f> points,
                                  const typename V::Fitted& fitted,
                                  const typename V::Placed& placed, const PartPose& pose,
                                  float scale, const Eigen::Vector3f& a_to_b_m, float margin_m) {
  { V::fit(points) } -> std::same_as<typename V::Fitted>;
  { V::place(fitted, pose, scale) } -> std::same_as<typename V::Placed>;
  { V::overlaps(placed, placed, a_to_b_m, margin_m) } -> std::same_as<bool>;
  { V::volume_m3(fitted) } -> std::same_as<double>;
};

/// Volume that can also be updated from the vertices.
template <typename V>
concept RefittedVolume = BoundingVolume<V> &&
    requires(std::span<const Eigen::Vector3f> points, const PartPose& pose, float scale) {
  { V::refit(points, pose, scale) } -> std::same_as<typename V::Placed>;
};

/// Margin for the float rounding in placing and testing any volume, in metres. With p, q all points
/// of the two parts, `reach_m` bounds |a_to_b| + |t_a| + |t_b| + s_a |p| + s_b |q|.
/// Placing and testing round each such length at most 40 times, by half a unit (6e-8) each. A
/// rotation from a chain of joints deviates from orthonormal by about 20 such roundings. The sum is
/// 4e-6 m per metre, doubled here.
constexpr float rounding_margin_m(float reach_m) { return 8e-6f * reach_m; }

}  // namespace throng
