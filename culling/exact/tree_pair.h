// What walks over the triangles of two parts have in common: one part's frame seen from the
// other's, and which of two nodes to open. One rule: in double precision; rotations that were
// rounded to float are taken as they are, so the inverse is a true one.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>

#include "base/pose.h"
#include "culling/exact/triangle_bvh.h"
#include "culling/exact/triangle_test.h"

namespace throng {

inline Eigen::Vector3d to_double(const std::array<float, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

inline Eigen::Matrix3d scaled_rotation(const PartPose& pose, float scale) {
  Eigen::Matrix3d out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      out(r, c) = static_cast<double>(scale) * static_cast<double>(pose.rows[r][c]);
  return out;
}

inline Eigen::Vector3d translation(const PartPose& pose) {
  return {static_cast<double>(pose.rows[0][3]), static_cast<double>(pose.rows[1][3]),
          static_cast<double>(pose.rows[2][3])};
}

/// B's part frame seen from A's: a = linear * b + offset, in A's unit of length.
struct Relative {
  Eigen::Matrix3d linear, inverse;
  Eigen::Matrix3d linear_abs, inverse_abs;
  Eigen::Vector3d offset;

  /// a_to_b_m is B's root minus A's.
  Relative(const PartPose& pose_a, float scale_a, const PartPose& pose_b, float scale_b,
           const Eigen::Vector3f& a_to_b_m) {
    const Eigen::Matrix3d world_from_a = scaled_rotation(pose_a, scale_a);
    const Eigen::Matrix3d world_from_b = scaled_rotation(pose_b, scale_b);
    const Eigen::Matrix3d a_from_world = world_from_a.inverse();
    linear = a_from_world * world_from_b;
    inverse = world_from_b.inverse() * world_from_a;
    offset = a_from_world * (a_to_b_m.cast<double>() + translation(pose_b) - translation(pose_a));
    linear_abs = linear.cwiseAbs();
    inverse_abs = inverse.cwiseAbs();
  }
};

/// Squared, from a point in the same frame to the box.
inline double squared_to_box(const TriangleBvh::Node& node, const Eigen::Vector3d& from) {
  return ((from - to_double(node.centre_m)).cwiseAbs() - to_double(node.half_m))
      .cwiseMax(0)
      .squaredNorm();
}

/// The sum of the half sides.
inline double width(const TriangleBvh::Node& node) {
  return static_cast<double>(node.half_m[0]) + static_cast<double>(node.half_m[1]) +
         static_cast<double>(node.half_m[2]);
}

/// Whether the node of A is to be opened rather than that of B: the wider, as long as it is no
/// leaf. One of them is not. `ratio`: B's unit of length in A's.
inline bool opens_a(const TriangleBvh::Node& a, const TriangleBvh::Node& b, double ratio) {
  return b.count > 0 || (a.count == 0 && width(a) > ratio * width(b));
}

inline Triangle in_own_frame(const std::array<Eigen::Vector3f, 3>& corners) {
  return {{corners[0].cast<double>(), corners[1].cast<double>(), corners[2].cast<double>()}};
}

}  // namespace throng
