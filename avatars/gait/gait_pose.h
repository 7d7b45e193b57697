// PosableModel poses links in double precision, to fit gaits and bounds; runs use
// forward_kinematics().
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "avatars/model/model.h"

namespace throng {

class PosableModel {
 public:
  explicit PosableModel(const Model& model);

  const Model& model() const { return *model_; }

  /// Index into Robot::joints, or -1.
  int joint_of(const std::string& name) const;
  /// Column that drives the joint, or -1. For a mimic joint: the column of its leader.
  int column_of_joint(int joint) const { return drives_[static_cast<size_t>(joint)].column; }
  /// Returns the joint's movement per unit of its column: 1, or a mimic's multiplier.
  double gain_of_joint(int joint) const { return drives_[static_cast<size_t>(joint)].gain; }

  /// Returns the joint "head_yaw" if it turns the head alone about an upright axis; otherwise -1.
  int head_yaw_joint() const;

  std::vector<double> rest() const;
  double clamped(int column, double value) const;

  /// root_from_link of every link; `columns` as in a posture row.
  void pose(const std::vector<double>& columns,
            std::vector<Eigen::Isometry3d>& root_from_link) const;

 private:
  struct Drive {
    int column = -1;
    double gain = 0;
    double offset = 0;
  };
  const Model* model_;
  std::vector<Drive> drives_;  // one per joint
};

}  // namespace throng
