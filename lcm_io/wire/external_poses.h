// Poses of externally controlled avatars from pose_command_t and step_reply_t.
// Invariant: a message is checked completely before any avatar moves.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string>

#include "scenes/motion/external_avatars.h"
#include "scenes/run/sink.h"

namespace throng {

inline size_t joints_of(const RunInfo& run, size_t avatar) {
  return run.models[run.model_of_avatar[avatar]]->kinematics.columns().size();
}

/// Returns why a decoded message does not suit this group, or "".
template <class Message>
std::string defect_for_group(const RunInfo& run, uint16_t group, const Message& message) {
  size_t columns = 0;
  for (const int32_t avatar : message.avatar) {
    const auto id = static_cast<size_t>(avatar);
    if (avatar < 0 || id >= run.group_of_avatar.size() || run.group_of_avatar[id] != group)
      return fmt::format("avatar {} is not of group '{}'", avatar, run.groups[group]);
    columns += joints_of(run, id);
  }
  if (!message.joint_positions.empty() && message.joint_positions.size() != columns)
    return fmt::format("{} joint positions, expected {}", message.joint_positions.size(), columns);
  return "";
}

/// Calls take(id, pose) for each avatar of a message without a defect.
template <class Message, class Take>
void for_each_pose(const RunInfo& run, const Message& message, const Take& take) {
  const std::span<const double> joints = message.joint_positions;
  size_t first = 0;
  for (size_t i = 0; i < message.avatar.size(); ++i) {
    const auto id = static_cast<uint32_t>(message.avatar[i]);
    ExternalPose pose;
    pose.root.position_m = {message.x_m[i], message.y_m[i], message.z_m[i]};
    pose.root.world_from_root = {message.qw[i], message.qx[i], message.qy[i], message.qz[i]};
    pose.velocity_mps = {static_cast<double>(message.vx_mps[i]),
                         static_cast<double>(message.vy_mps[i])};
    if (!joints.empty()) {
      pose.joints = joints.subspan(first, joints_of(run, id));
      first += pose.joints.size();
    }
    take(id, pose);
  }
}

}  // namespace throng
