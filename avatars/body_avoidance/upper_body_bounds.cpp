#include "avatars/body_avoidance/upper_body_bounds.h"

#include <algorithm>
#include <cmath>

#include "avatars/body_avoidance/body_avoidance_kernels.h"
#include "avatars/gait/gait_pose.h"

namespace throng {
namespace {

/// Returns whether the head joint turns about the axis of the trunk joint above it.
bool is_on_axis(const PosableModel& model, const Joint& head, const AvoidanceColumns& columns) {
  const Robot& robot = model.model().robot;
  if (head.parent_link <= 0) return false;
  const auto trunk_joint = static_cast<size_t>(head.parent_link - 1);
  const Joint& trunk = robot.joints[trunk_joint];
  if (model.column_of_joint(static_cast<int>(trunk_joint)) != columns.trunk) return false;
  constexpr double kTolerance = 1e-6;
  const Eigen::Vector3d to = head.parent_from_joint.translation();
  const Eigen::Vector3d axis = head.parent_from_joint.linear() * head.axis;
  return to.cross(trunk.axis).norm() < kTolerance && (axis - trunk.axis).norm() < kTolerance;
}

std::vector<int> links_of(const auto& parts) {
  std::vector<int> links;
  for (const auto& upper : parts)
    if (std::find(links.begin(), links.end(), upper.part->link) == links.end())
      links.push_back(upper.part->link);
  return links;
}

}  // namespace

std::vector<UpperBodyBounds::UpperPart> UpperBodyBounds::upper_parts(
    const Model& model, const AvoidanceColumns& columns) {
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
    // Its rotation cancels the trunk's: see apply_avoidance().
    stays[child] = turns[child] && is_on_axis(posable, joint, columns);
  }
  std::vector<UpperPart> upper;
  for (const Part& part : model.parts) {
    const auto link = static_cast<size_t>(part.link);
    if (is_upper[link] && !stays[link] && !part.mesh.vertices.empty())
      upper.push_back({&part, turns[link]});
  }
  return upper;
}

UpperBodyBounds::UpperBodyBounds(const Model& model, const AvoidanceColumns& columns)
    : UpperBodyBounds(model, upper_parts(model, columns)) {}

UpperBodyBounds::UpperBodyBounds(const Model& model, const std::vector<UpperPart>& parts)
    : kinematics_(model.robot, links_of(parts)) {
  const std::vector<int> links = links_of(parts);
  const auto add_part = [&](const UpperPart& upper) {
    const auto link = std::find(links.begin(), links.end(), upper.part->link) - links.begin();
    add(upper, static_cast<uint32_t>(link));
  };
  for (const UpperPart& upper : parts) add_part(upper);
  while (shapes_.link.size() % kShapeLanes != 0) add_part(parts.back());
}

/// Adds a part that turns about the z axis of its frame, at any rotation.
void UpperBodyBounds::add(const UpperPart& upper, uint32_t link) {
  const std::vector<Eigen::Vector3f>& vertices = upper.part->mesh.vertices;
  Eigen::AlignedBox3f box;
  float farthest = 0;
  for (const Eigen::Vector3f& vertex : vertices) {
    box.extend(vertex);
    farthest = std::max(farthest, vertex.head<2>().norm());
  }
  if (upper.turns) {
    box.min().head<2>().setConstant(-farthest);
    box.max().head<2>().setConstant(farthest);
  }
  const Eigen::Vector3f middle = box.center(), half = 0.5f * box.sizes();
  float widest = upper.turns ? 1 : 0;  // ratio of the ellipse to the one inscribed in the box
  for (const Eigen::Vector3f& vertex : vertices) {
    if (upper.turns) break;
    const Eigen::Vector2f across =
        (vertex - middle).head<2>().cwiseQuotient(half.head<2>().cwiseMax(1e-6f));
    widest = std::max(widest, across.norm());
  }
  shapes_.link.push_back(link);
  for (int axis = 0; axis < 3; ++axis) {
    shapes_.middle_m[axis].push_back(middle[axis]);
    shapes_.half_m[axis].push_back(half[axis]);
    if (axis < 2) shapes_.ellipse_m[axis].push_back(widest * half[axis]);
  }
}

std::optional<RootBox> UpperBodyBounds::box_within(std::span<const PartPose> poses,
                                                   const RoundBounds& all,
                                                   SimdTarget target) const {
  RootBox box;
  if (!find_upper_box(shapes_, poses, all, target, box)) return {};
  return box;
}

}  // namespace throng
