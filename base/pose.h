// PartPose is the pose of a body part in kinematics, culling and messages; RootPose is the pose of
// an avatar.
// Invariant: translations are relative to the avatar's root position, in world axes. Float
// precision therefore does not depend on the distance from the world's origin.
#pragma once

#include <Eigen/Geometry>

namespace throng {

/// world_from_part without the root position: rows of [R | t], t in metres.
/// Point p of a part scaled by s lies at root_position + R * (s * p) + t.
struct alignas(16) PartPose {
  float rows[3][4];
};
static_assert(sizeof(PartPose) == 48);

/// Pose of an avatar's root. The root is the URDF's root link; for people the point on the ground
/// between the feet, x forward, z up.
struct RootPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaternionf world_from_root = Eigen::Quaternionf::Identity();
};

/// Box in a body's root frame, in metres, with its scale applied; unknown by default.
struct RootBox {
  float min_m[3] = {1, 1, 1};
  float max_m[3] = {-1, -1, -1};
  bool is_known() const { return min_m[0] <= max_m[0]; }
};

inline PartPose to_part_pose(const Eigen::Isometry3d& pose) {
  PartPose out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) out.rows[r][c] = static_cast<float>(pose.matrix()(r, c));
  return out;
}

inline Eigen::Isometry3d to_isometry(const PartPose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) out.matrix()(r, c) = static_cast<double>(pose.rows[r][c]);
  return out;
}

}  // namespace throng
