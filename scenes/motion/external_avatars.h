// ExternalAvatars holds the poses of avatars that are controlled from outside the simulation.
// Invariant: every pose is clamped to the bounds of the body and the ground; no input causes a
// missed contact.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/pose.h"
#include "kinematics/kinematics.h"
#include "scenes/file/scene.h"

namespace throng {

class Crowd;

/// Pose of an externally controlled avatar from the next step on.
struct ExternalPose {
  RootPose root;
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  /// Walks by its gait: height, tilt and joints are those of the gait.
  bool walks = false;
  /// A posture row (rad or m, by column of the model); empty: joints stay as they are.
  std::span<const double> joints;
};

/// Maximum height of an external root above or below the ground.
inline constexpr double kMaxExternalHeight_m = 100;
/// Maximum speed that steering assumes; robots among people are slower.
inline constexpr double kMaxExternalSpeed_mps = 20;

/// Clamps a pose to a root above `ground`, a unit quaternion and a possible speed. NaN is replaced
/// by the value of `last`. Adds the number of changed values to `clamped`; normalising a quaternion
/// does not count.
ExternalPose clamped_pose(const ExternalPose& pose, const ExternalPose& last,
                          const Rectangle& ground, int& clamped);

/// Writes joints into a row, clamped to the limits of the model; counts as clamped_pose() does.
void write_row(std::span<const double> joints, const FlatModel& kinematics, std::span<float> row,
               int& clamped);

class ExternalAvatars {
 public:
  /// Adds an avatar, in ascending order. Joints start at zero, or at the nearest limit.
  void add(uint32_t avatar, const FlatModel& kinematics, const RootPose& root);
  bool empty() const { return all_.empty(); }

  /// See Simulation::set_pose().
  int set_pose(uint32_t avatar, const ExternalPose& pose, const Rectangle& ground);

  /// Current pose without joints; null if the avatar is not externally controlled.
  const ExternalPose* pose(uint32_t avatar) const;

  /// Sets the agents of the crowd to these poses, after steering.
  void apply_external(Crowd& crowd) const;
  /// Lets avatars that walk stand from the next step on, unless they get another pose.
  void stop_walking();
  /// Sets the roots of avatars that do not walk.
  void place(std::span<RootPose> roots) const;
  void archive(Archive& a);
  /// Sets the posture row of each avatar, null for one that walks. Pointers are valid as long as
  /// this object.
  void bind_rows(std::span<const float*> rows) const;

 private:
  struct ExternalAvatar {
    uint32_t avatar = 0;
    const FlatModel* kinematics = nullptr;
    ExternalPose pose;
    std::vector<float> row;
  };
  const ExternalAvatar* find(uint32_t avatar) const;

  static constexpr uint32_t kNone = UINT32_MAX;
  std::vector<ExternalAvatar> all_;
  std::vector<uint32_t> places_;  ///< index into all_ per avatar; kNone: not external
};

}  // namespace throng
