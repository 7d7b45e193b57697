// pose_math rotates and places points by a PartPose.
// Invariant: sums run x, y, z from left to right; SIMD lanes repeat them bit for bit.
#pragma once

#include <Eigen/Core>

#include "base/pose.h"

namespace throng {

/// R * v.
inline Eigen::Vector3f rotated(const PartPose& pose, const Eigen::Vector3f& v) {
  const auto& r = pose.rows;
  return {r[0][0] * v.x() + r[0][1] * v.y() + r[0][2] * v.z(),
          r[1][0] * v.x() + r[1][1] * v.y() + r[1][2] * v.z(),
          r[2][0] * v.x() + r[2][1] * v.y() + r[2][2] * v.z()};
}

/// R^T * v: a world vector in the part's frame.
inline Eigen::Vector3f rotated_back(const PartPose& pose, const Eigen::Vector3f& v) {
  const auto& r = pose.rows;
  return {r[0][0] * v.x() + r[1][0] * v.y() + r[2][0] * v.z(),
          r[0][1] * v.x() + r[1][1] * v.y() + r[2][1] * v.z(),
          r[0][2] * v.x() + r[1][2] * v.y() + r[2][2] * v.z()};
}

inline Eigen::Vector3f translation_m(const PartPose& pose) {
  return {pose.rows[0][3], pose.rows[1][3], pose.rows[2][3]};
}

/// Position of a point of a part with scale `scale`, relative to the body's root, in world axes.
inline Eigen::Vector3f placed_point(const PartPose& pose, float scale, const Eigen::Vector3f& p) {
  return rotated(pose, scale * p) + translation_m(pose);
}

}  // namespace throng
