#include "kinematics/kdl_tree.h"

#include <fmt/format.h>

#include <stdexcept>

namespace throng {
namespace {

KDL::Vector to_kdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame to_kdl(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                        r(2, 2)),
          to_kdl(Eigen::Vector3d(pose.translation()))};
}

KDL::Joint to_kdl(const Joint& joint) {
  const KDL::Frame parent_from_joint = to_kdl(joint.parent_from_joint);
  const KDL::Vector axis = parent_from_joint.M * to_kdl(Eigen::Vector3d(joint.axis.normalized()));
  switch (joint.kind) {
    case Joint::Kind::kFixed:
      break;
    case Joint::Kind::kRevolute:
    case Joint::Kind::kContinuous:
      return {joint.name, parent_from_joint.p, axis, KDL::Joint::RotAxis};
    case Joint::Kind::kPrismatic:
      return {joint.name, parent_from_joint.p, axis, KDL::Joint::TransAxis};
  }
  return KDL::Joint(joint.name, KDL::Joint::Fixed);
}

}  // namespace

KDL::Tree to_kdl(const Robot& robot) {
  KDL::Tree tree(robot.links.front().name);
  for (const Joint& joint : robot.joints) {
    const std::string& parent = robot.links[static_cast<size_t>(joint.parent_link)].name;
    const std::string& child = robot.links[static_cast<size_t>(joint.child_link)].name;
    const KDL::Segment segment(child, to_kdl(joint), to_kdl(joint.parent_from_joint));
    if (!tree.addSegment(segment, parent))
      throw std::logic_error(fmt::format("KDL rejects the link {} below {}", child, parent));
  }
  return tree;
}

}  // namespace throng
