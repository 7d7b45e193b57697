#include <algorithm>
#include <cmath>

#include "avatars/gait/gait_table.h"

namespace throng {
namespace {

// Full standing motion up to the first square root of the relative speed (0.8 m/s for an adult),
// none from the second (1.3 m/s): slow walkers may still be in transition.
constexpr double kFullSqrtSpeed = 0.95, kNoneSqrtSpeed = 1.2;

bool all_hang_from(const Robot& robot, int link) {
  std::vector<bool> hangs(robot.links.size(), false);
  hangs[static_cast<size_t>(link)] = true;
  for (const Joint& joint : robot.joints) {  // parents first
    const auto parent = static_cast<size_t>(joint.parent_link);
    if (hangs[parent]) hangs[static_cast<size_t>(joint.child_link)] = true;
  }
  return std::all_of(hangs.begin() + 1, hangs.end(), [](bool each) { return each; });
}

/// Returns the column of the joint that moves the whole body along the root's y axis, or -1.
int lateral_column(const PosableModel& model) {
  const int lateral = model.joint_of("pelvis_lateral");
  if (lateral < 0) return -1;
  const Joint& joint = model.model().robot.joints[static_cast<size_t>(lateral)];
  const Eigen::Vector3d direction = joint.parent_from_joint.linear() * joint.axis;
  const bool moves_all = joint.kind == Joint::Kind::kPrismatic && joint.parent_link == 0 &&
                         direction.y() > 1 - 1e-9 && model.gain_of_joint(lateral) == 1 &&
                         all_hang_from(model.model().robot, joint.child_link);
  return moves_all ? model.column_of_joint(lateral) : -1;
}

/// Returns the maximum distance from a joint of any vertex on the links below it.
double reach_from(const PosableModel& model, int joint) {
  const Robot& robot = model.model().robot;
  const int end = robot.joints[static_cast<size_t>(joint)].child_link;
  double max_m = 0;
  for (const Part& part : model.model().parts) {
    double reach_m = 0;
    for (const Eigen::Vector3f& vertex : part.mesh.vertices)
      reach_m = std::max(reach_m, static_cast<double>(vertex.norm()));
    int link = part.link;
    while (link > 0 && link != end) {
      const Joint& above = robot.joints[static_cast<size_t>(link - 1)];
      reach_m += above.parent_from_joint.translation().norm();
      if (above.kind == Joint::Kind::kPrismatic)
        reach_m += std::max(std::abs(above.lower), std::abs(above.upper));
      link = above.parent_link;
    }
    if (link == end) max_m = std::max(max_m, reach_m);
  }
  return max_m;
}

/// Returns the remaining range of a column to its limits, the same to either side, at one speed.
double range_of(const PosableModel& model, const GaitTable& table, int column, int speed) {
  const JointColumn& limits = model.model().kinematics.columns()[static_cast<size_t>(column)];
  float range = std::max(limits.upper - limits.lower, 0.0f);
  for (int phase = 0; phase <= table.phases; ++phase) {
    const float value = table.row(speed, phase)[column];
    range = std::min({range, limits.upper - value, value - limits.lower});
  }
  return std::max(static_cast<double>(range), 0.0);
}

}  // namespace

StandingJoints standing_joints(const PosableModel& model, const GaitTable& table,
                               double max_sqrt_speed) {
  StandingJoints out;
  out.lateral_column = lateral_column(model);
  for (size_t side = 0; side < 2; ++side) {
    const int joint =
        model.joint_of(side == 0 ? "right_shoulder_abduction" : "left_shoulder_abduction");
    if (joint < 0 || model.column_of_joint(joint) < 0 ||
        std::abs(model.gain_of_joint(joint)) != 1) {
      out.arm_columns = {-1, -1};
      break;
    }
    out.arm_columns[side] = model.column_of_joint(joint);
    out.arms_m = std::max(out.arms_m, reach_from(model, joint));
  }
  for (int speed = 0; speed < table.speeds; ++speed) {
    const double sqrt_speed = max_sqrt_speed * speed / std::max(table.speeds - 1, 1);
    double share =
        std::clamp((kNoneSqrtSpeed - sqrt_speed) / (kNoneSqrtSpeed - kFullSqrtSpeed), 0.0, 1.0);
    const auto limit = [&](int column, float max_offset) {
      if (column >= 0)
        share = std::min(share,
                         range_of(model, table, column, speed) / static_cast<double>(max_offset));
    };
    limit(out.lateral_column, kMaxShift_m);
    for (const int column : out.arm_columns) limit(column, kBreath_rad);
    out.shares.push_back(share);
  }
  return out;
}

}  // namespace throng
