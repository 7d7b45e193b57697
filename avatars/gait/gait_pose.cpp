#include "avatars/gait/gait_pose.h"

#include <algorithm>

#include "base/portable_math.h"

namespace throng {

PosableModel::PosableModel(const Model& model) : model_(&model) {
  const std::vector<Joint>& joints = model.robot.joints;
  for (const Joint& joint : joints) {
    Drive drive{-1, 1, 0};
    const Joint* leader = &joint;
    while (leader->mimic) {
      drive.offset += drive.gain * leader->mimic->offset;
      drive.gain *= leader->mimic->multiplier;
      leader = &joints[static_cast<size_t>(leader->mimic->joint)];
    }
    if (joint.kind != Joint::Kind::kFixed) drive.column = model.kinematics.column_of(leader->name);
    drives_.push_back(drive);
  }
}

int PosableModel::joint_of(const std::string& name) const {
  const std::vector<Joint>& joints = model_->robot.joints;
  const auto found = std::find_if(joints.begin(), joints.end(),
                                  [&](const Joint& joint) { return joint.name == name; });
  return found == joints.end() ? -1 : static_cast<int>(found - joints.begin());
}

int PosableModel::head_yaw_joint() const {
  const int yaw_joint = joint_of("head_yaw");
  if (yaw_joint < 0 || column_of_joint(yaw_joint) < 0) return -1;
  const std::vector<Joint>& joints = model_->robot.joints;
  const Joint& joint = joints[static_cast<size_t>(yaw_joint)];
  if (joint.kind == Joint::Kind::kPrismatic || joint.mimic) return -1;
  for (const Joint& other : joints) {
    const bool follows = other.mimic && other.mimic->joint == yaw_joint;
    if (other.parent_link == joint.child_link || follows) return -1;
  }
  return yaw_joint;
}

double PosableModel::clamped(int column, double value) const {
  const JointColumn& limits = model_->kinematics.columns()[static_cast<size_t>(column)];
  return std::clamp(value, static_cast<double>(limits.lower), static_cast<double>(limits.upper));
}

std::vector<double> PosableModel::rest() const {
  std::vector<double> columns(static_cast<size_t>(model_->kinematics.column_count()));
  for (size_t c = 0; c < columns.size(); ++c) columns[c] = clamped(static_cast<int>(c), 0);
  return columns;
}

void PosableModel::pose(const std::vector<double>& columns,
                        std::vector<Eigen::Isometry3d>& root_from_link) const {
  const std::vector<Joint>& joints = model_->robot.joints;
  root_from_link.resize(model_->robot.links.size());
  root_from_link[0] = Eigen::Isometry3d::Identity();
  for (size_t j = 0; j < joints.size(); ++j) {
    const Joint& joint = joints[j];
    const Drive& drive = drives_[j];
    Eigen::Isometry3d moved =
        root_from_link[static_cast<size_t>(joint.parent_link)] * joint.parent_from_joint;
    if (drive.column >= 0) {
      const double q = drive.offset + drive.gain * columns[static_cast<size_t>(drive.column)];
      if (joint.kind == Joint::Kind::kPrismatic)
        moved.translate(q * joint.axis);
      else
        moved.rotate(turn_about(joint.axis, q));
    }
    root_from_link[static_cast<size_t>(joint.child_link)] = moved;
  }
}

}  // namespace throng
