// What a bounding volume is: one concept for all of them; volume_list.h has the list.
// One rule: overlaps() == false proves that the enclosed points are apart; true means "maybe".
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <span>

#include "base/pose.h"

namespace throng {

/// A volume is fitted once to a part's points, in the part's frame; placed whenever the part has
/// moved (the paper's update, C_u); and tested pair by pair (the paper's test, C_v). Poses are
/// relative to each body's own root, so a test takes `a_to_b_m`, B's root minus A's, formed in
/// double and rounded once.
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

/// A volume that can also be updated from the vertices themselves.
template <typename V>
concept RefittedVolume = BoundingVolume<V> &&
    requires(std::span<const Eigen::Vector3f> points, const PartPose& pose, float scale) {
  { V::refit(points, pose, scale) } -> std::same_as<typename V::Placed>;
};

/// The margin that covers what float loses in placing and testing any of the volumes.
/// `reach_m` bounds |a_to_b| + |t_a| + |t_b| + s_a |p| + s_b |q| over all points p, q of the parts.
/// Placing and testing round each such length at most 40 times, half a unit (6e-8) each, and a
/// rotation that went through a chain of joints is off from orthonormal by some 20 such roundings:
/// 4e-6 m per metre, doubled.
constexpr float rounding_margin_m(float reach_m) { return 8e-6f * reach_m; }

}  // namespace throng
