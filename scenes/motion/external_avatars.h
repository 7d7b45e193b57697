// Avatars that something outside moves: a robot whose controller is under test.
// One rule: whatever comes in is brought within what the bounds of the body hold, so that no
// contact is missed; nothing that comes can be anything but a pose.
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

/// Where a driven avatar is from the next step on.
struct ExternalPose {
  RootPose root;
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  /// A posture row (rad or m, by column of the model); empty: joints stay as they are.
  std::span<const double> joints;
};

/// How far above or below the ground a driven root may be.
inline constexpr double kMaxExternalHeight_m = 100;
/// How fast steering may be led to believe that it comes; faster is no robot among people.
inline constexpr double kMaxExternalSpeed_mps = 20;

/// The nearest pose with a root above `ground`, a unit quaternion, a possible speed; `clamped`
/// counts the numbers that were changed (a quaternion is only brought to length 1). What is no
/// number becomes that of `last`.
ExternalPose clamped_pose(const ExternalPose& pose, const ExternalPose& last,
                          const Rectangle& ground, int& clamped);

/// Writes the joints into a row of floats within the limits of the model.
void write_row(std::span<const double> joints, const FlatModel& kinematics, std::span<float> row,
               int& clamped);

/// The driven avatars of a run and where they are.
class ExternalAvatars {
 public:
  /// In ascending order. Its joints are at zero, or as near as their limits let them.
  void add(uint32_t avatar, const FlatModel& kinematics, const RootPose& root);
  bool empty() const { return all_.empty(); }

  /// See Simulation::set_pose().
  int set_pose(uint32_t avatar, const ExternalPose& pose, const Rectangle& ground);

  /// Where it is held, its joints left out; null if the avatar is not driven.
  const ExternalPose* pose(uint32_t avatar) const;

  /// Puts them where they are, after steering and over what it made of them.
  void apply_external(Crowd& crowd) const;
  void place(std::span<RootPose> roots) const;
  /// Where everybody is, for checkpoints.
  void archive(Archive& a);
  /// Sets the posture row of each; the pointers hold as long as this object.
  void bind_rows(std::span<const float*> rows) const;

 private:
  struct ExternalAvatar {
    uint32_t avatar = 0;
    const FlatModel* kinematics = nullptr;
    ExternalPose pose;  ///< its joints are in row
    std::vector<float> row;
  };
  const ExternalAvatar* find(uint32_t avatar) const;

  std::vector<ExternalAvatar> all_;
};

}  // namespace throng
