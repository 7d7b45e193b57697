// KdlOracle poses a robot with KDL's recursive solver, one link at a time: the slow reference.
#pragma once

#include <Eigen/Geometry>
#include <kdl/treefksolverpos_recursive.hpp>
#include <string>
#include <vector>

#include "kinematics/kdl_tree.h"

namespace throng {

class KdlOracle {
 public:
  explicit KdlOracle(const Robot& robot)
      : robot_(robot), tree_(to_kdl(robot)), solver_(tree_), joints_(tree_.getNrOfJoints()) {}

  /// `posture`: values by column, for independent joints in the robot's order.
  void set(const float* posture) {
    std::vector<double> values(robot_.joints.size());
    for (size_t i = 0; i < values.size(); ++i)
      if (robot_.joints[i].kind != Joint::Kind::kFixed && !robot_.joints[i].mimic)
        values[i] = static_cast<double>(*posture++);
    for (size_t i = 0; i < values.size(); ++i) {
      if (robot_.joints[i].kind == Joint::Kind::kFixed) continue;
      const std::string& link = robot_.links[i + 1].name;
      joints_(tree_.getSegment(link)->second.q_nr) = value_of(values, i);
    }
  }

  Eigen::Isometry3d root_from(const std::string& link) {
    if (joints_.rows() == 0)
      return Eigen::Isometry3d::Identity();  // KDL reads joint 0 even if there is none
    KDL::Frame frame;
    if (solver_.JntToCart(joints_, frame, link) < 0)
      throw std::logic_error("KDL has no link " + link);
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) out.linear()(r, c) = frame.M(r, c);
      out.translation()[r] = frame.p(r);
    }
    return out;
  }

 private:
  double value_of(const std::vector<double>& values, size_t joint) const {
    const auto& mimic = robot_.joints[joint].mimic;
    if (!mimic) return values[joint];
    return mimic->multiplier * value_of(values, static_cast<size_t>(mimic->joint)) + mimic->offset;
  }

  const Robot& robot_;
  KDL::Tree tree_;
  KDL::TreeFkSolverPos_recursive solver_;
  KDL::JntArray joints_;
};

}  // namespace throng
