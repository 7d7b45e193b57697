#include "avatars/yielding/upper_room.h"

#include <algorithm>
#include <cmath>

#include "avatars/gait/gait_pose.h"

namespace throng {
namespace {

// Single precision in postures and kinematics: ten times what was measured.
constexpr float kSlack_m = 1e-4f;

/// Whether a head that hangs from the trunk turns about the axis that the trunk turns about.
bool is_on_axis(const PosableModel& model, const Joint& head, const YieldColumns& columns) {
  const Robot& robot = model.model().robot;
  if (head.parent_link <= 0) return false;
  const auto trunk_joint = static_cast<size_t>(head.parent_link - 1);
  const Joint& trunk = robot.joints[trunk_joint];
  if (model.column_of_joint(static_cast<int>(trunk_joint)) != columns.trunk) return false;
  constexpr double kNearly = 1e-6;
  const Eigen::Vector3d to = head.parent_from_joint.translation();
  const Eigen::Vector3d axis = head.parent_from_joint.linear() * head.axis;
  return to.cross(trunk.axis).norm() < kNearly && (axis - trunk.axis).norm() < kNearly;
}

}  // namespace

UpperRoom::UpperRoom(const Model& model, const YieldColumns& columns) {
  const PosableModel posable(model);
  const Robot& robot = model.robot;
  std::vector<bool> is_upper(robot.links.size()), turns(robot.links.size()),
      stays(robot.links.size());
  for (size_t j = 0; j < robot.joints.size(); ++j) {  // parents first
    const Joint& joint = robot.joints[j];
    const int column = posable.column_of_joint(static_cast<int>(j));
    const auto child = static_cast<size_t>(joint.child_link);
    is_upper[child] = is_upper[static_cast<size_t>(joint.parent_link)] ||
                      (column >= 0 && column == columns.trunk);
    turns[child] = column >= 0 && column == columns.head;
    // Its turns cancel the trunk's: see put_yield().
    stays[child] = turns[child] && is_on_axis(posable, joint, columns);
  }
  for (size_t i = 0; i < model.parts.size(); ++i) {
    const Part& part = model.parts[i];
    const auto link = static_cast<size_t>(part.link);
    if (is_upper[link] && !stays[link] && !part.mesh.vertices.empty())
      shapes_.push_back(around(part, static_cast<uint32_t>(i), turns[link]));
  }
}

/// Of a part that turns about its frame's z axis, whichever way it is turned.
UpperRoom::Shape UpperRoom::around(const Part& part, uint32_t index, bool turns) {
  Eigen::AlignedBox3f box;
  float farthest = 0;
  for (const Eigen::Vector3f& vertex : part.mesh.vertices) {
    box.extend(vertex);
    farthest = std::max(farthest, vertex.head<2>().norm());
  }
  if (turns) {
    box.min().head<2>().setConstant(-farthest);
    box.max().head<2>().setConstant(farthest);
  }
  const Eigen::Vector3f middle = box.center(), half = 0.5f * box.sizes();
  float widest = turns ? 1 : 0;  // of the ellipse that the box is around, so much wider
  for (const Eigen::Vector3f& vertex : part.mesh.vertices) {
    if (turns) break;
    const Eigen::Vector2f across =
        (vertex - middle).head<2>().cwiseQuotient(half.head<2>().cwiseMax(1e-6f));
    widest = std::max(widest, across.norm());
  }
  return {index,
          {middle.x(), middle.y(), middle.z()},
          {half.x(), half.y(), half.z()},
          {widest * half.x(), widest * half.y()}};
}

UpperRoom::Extent UpperRoom::extent_of(const Shape& shape, const PartPose& pose) {
  Extent extent;
  for (int axis = 0; axis < 3; ++axis) {
    const float* r = pose.rows[axis];
    const float *m = shape.middle_m, *h = shape.half_m;
    const float middle = r[0] * m[0] + r[1] * m[1] + r[2] * m[2] + r[3];
    const float x = r[0] * shape.ellipse_m[0], y = r[1] * shape.ellipse_m[1];
    const float across =
        std::min(std::abs(r[0]) * h[0] + std::abs(r[1]) * h[1], std::sqrt(x * x + y * y));
    const float half = across + std::abs(r[2]) * h[2] + kSlack_m;
    extent.low_m[axis] = middle - half;
    extent.high_m[axis] = middle + half;
  }
  return extent;
}

std::optional<RootBox> UpperRoom::box_within(std::span<const PartPose> poses, float sphere_z_m,
                                             float sphere_m, float cylinder_m) const {
  RootBox box;
  for (const Shape& shape : shapes_) {
    const Extent extent = extent_of(shape, poses[shape.part]);
    const auto farthest = [&](int axis, float from) {
      const float most = std::max(from - extent.low_m[axis], extent.high_m[axis] - from);
      return most * most;
    };
    const float across = farthest(0, 0) + farthest(1, 0);
    if (!(across <= cylinder_m * cylinder_m &&
          across + farthest(2, sphere_z_m) <= sphere_m * sphere_m))
      return {};
    const bool is_first = &shape == shapes_.data();
    for (int axis = 0; axis < 3; ++axis) {
      box.min_m[axis] =
          is_first ? extent.low_m[axis] : std::min(box.min_m[axis], extent.low_m[axis]);
      box.max_m[axis] =
          is_first ? extent.high_m[axis] : std::max(box.max_m[axis], extent.high_m[axis]);
    }
  }
  return box;
}

}  // namespace throng
