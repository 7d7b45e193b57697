#include "avatars/gait/gait_leg.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/elementary.h"

namespace throng {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// How exactly a leg's joints have to meet and be square for the closed form to hold.
constexpr double kSquare = 1e-3;

Matrix3d turn_y(double angle) { return turn_about(Vector3d::UnitY(), angle); }

Vector2d sagittal(const Vector3d& v) { return {v.x(), v.z()}; }

// (x, z) turned by `angle` about +y, toes down.
Vector2d turned(const Vector2d& v, double angle) {
  const auto [s, c] = sin_cos(angle);
  return {c * v.x() + s * v.y(), c * v.y() - s * v.x()};
}

double angle_from(const Vector2d& from, const Vector2d& to) {
  const Vector2d quarter(from.y(), -from.x());
  return arc_tan2(quarter.dot(to), from.dot(to));
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// The lower convex hull from left to right (Andrew 1979).
std::vector<Vector2d> lower_hull(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Vector2d& a, const Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Vector2d> hull;
  for (const Vector2d& p : points) {
    while (hull.size() >= 2 &&
           cross(hull.back() - hull[hull.size() - 2], p - hull[hull.size() - 2]) <= 0)
      hull.pop_back();
    hull.push_back(p);
  }
  return hull;
}

}  // namespace

std::optional<Leg> Leg::find(const PosableModel& model, const std::string& side) {
  const Robot& robot = model.model().robot;
  std::vector<Eigen::Isometry3d> zero;
  model.pose(std::vector<double>(static_cast<size_t>(model.model().kinematics.column_count()), 0.0),
             zero);
  const std::array<std::string, 5> names = {"_hip_flexion", "_hip_adduction", "_hip_rotation",
                                            "_knee_flexion", "_ankle_flexion"};
  struct Found {
    int joint;
    Axis axis;
    Vector3d origin;
  };
  std::vector<Found> chain;
  for (const std::string& name : names) {
    const int joint = model.joint_of(side + name);
    if (joint < 0 || model.column_of_joint(joint) < 0) return std::nullopt;
    const Joint& j = robot.joints[static_cast<size_t>(joint)];
    if (j.kind == Joint::Kind::kPrismatic || j.mimic) return std::nullopt;
    const Eigen::Isometry3d& frame = zero[static_cast<size_t>(j.child_link)];
    chain.push_back(
        {joint, {frame.linear() * j.axis, model.column_of_joint(joint)}, frame.translation()});
  }
  // Joints are stored parents first, so the order in the URDF is the order of the chain.
  std::sort(chain.begin(), chain.begin() + 3,
            [](const Found& a, const Found& b) { return a.joint < b.joint; });

  Leg leg;
  for (size_t i = 0; i < 3; ++i) {
    leg.hip_axes_[i] = chain[i].axis;
    if ((chain[i].origin - chain[2].origin).norm() > kSquare) return std::nullopt;
    const Vector3d& next = chain[(i + 1) % 3].axis.direction;
    if (std::abs(chain[i].axis.direction.dot(next)) > kSquare) return std::nullopt;
  }
  leg.knee_axis_ = chain[3].axis;
  leg.ankle_axis_ = chain[4].axis;
  for (const Axis& axis : {leg.knee_axis_, leg.ankle_axis_})
    if (1 - std::abs(axis.direction.y()) > kSquare) return std::nullopt;
  leg.hip_ = chain[2].origin;
  leg.ankle_ = chain[4].origin;
  leg.thigh_ = sagittal(chain[3].origin - leg.hip_);
  leg.shank_ = sagittal(leg.ankle_ - chain[3].origin);
  leg.sideways_ = leg.ankle_.y() - leg.hip_.y();
  leg.knee_side_ = chain[3].origin.y() - leg.hip_.y();
  leg.read_limbs(model,
                 {chain[0].joint, chain[1].joint, chain[2].joint, chain[3].joint, chain[4].joint});
  leg.read_foot(model, robot.joints[static_cast<size_t>(chain[4].joint)].child_link);
  if (leg.sole_.size() < 2 || leg.thigh_.norm() < kSquare || leg.shank_.norm() < kSquare)
    return std::nullopt;
  return leg;
}

namespace {

// The links from this one outwards, those from `end` on left out.
std::vector<bool> branch_of(const Robot& robot, int link, int end = -1) {
  std::vector<bool> in_branch(robot.links.size(), false);
  in_branch[static_cast<size_t>(link)] = true;
  for (const Joint& joint : robot.joints)
    if (in_branch[static_cast<size_t>(joint.parent_link)] && joint.child_link != end)
      in_branch[static_cast<size_t>(joint.child_link)] = true;
  return in_branch;
}

double distance_from_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const double share = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - share * (b - a)).norm();
}

}  // namespace

void Leg::read_limbs(const PosableModel& model, const std::array<int, 5>& joints) {
  const Robot& robot = model.model().robot;
  std::vector<Eigen::Isometry3d> zero;
  model.pose(std::vector<double>(static_cast<size_t>(model.model().kinematics.column_count()), 0.0),
             zero);
  const auto child = [&](size_t i) {
    return robot.joints[static_cast<size_t>(joints[i])].child_link;
  };
  const std::vector<bool> hip = branch_of(robot, child(0), child(2)),
                          thigh = branch_of(robot, child(2), child(3)),
                          shank = branch_of(robot, child(3), child(4));
  const Vector3d knee = zero[static_cast<size_t>(child(3))].translation();
  for (const Part& part : model.model().parts)
    for (const Eigen::Vector3f& vertex : part.mesh.vertices) {
      const auto link = static_cast<size_t>(part.link);
      const Vector3d p = zero[link] * vertex.cast<double>();
      // What sits between the hip's axes turns about the hip alone.
      if (hip[link]) thigh_radius_ = std::max(thigh_radius_, (p - hip_).norm());
      if (thigh[link])
        thigh_radius_ = std::max(thigh_radius_, distance_from_segment(p, hip_, knee));
      if (shank[link])
        shank_radius_ = std::max(shank_radius_, distance_from_segment(p, knee, ankle_));
    }
}

LegShape Leg::shape() const {
  LegShape shape;
  for (size_t axis = 0; axis < 3; ++axis) {
    shape.hip_axes[axis] = hip_axes_[axis].direction;
    shape.columns[axis] = hip_axes_[axis].column;
  }
  shape.columns[3] = knee_axis_.column;
  shape.columns[4] = ankle_axis_.column;
  shape.hip_m = hip_;
  shape.thigh_m = thigh_;
  shape.shank_m = shank_;
  shape.knee_side_m = knee_side_;
  shape.ankle_side_m = sideways_;
  shape.knee_sign = knee_axis_.direction.y();
  shape.ankle_sign = ankle_axis_.direction.y();
  shape.thigh_radius_m = thigh_radius_;
  shape.shank_radius_m = shank_radius_;
  for (const Vector3d& point : foot_) shape.foot_m.extend(point);
  // Of the part of the sole that a flat foot stands on.
  constexpr double kSole_m = 0.005;
  for (const Vector3d& point : foot_)
    if (point.z() < shape.foot_m.min().z() + kSole_m)
      shape.sole_half_width_m = std::max(shape.sole_half_width_m, std::abs(point.y()));
  return shape;
}

void Leg::read_foot(const PosableModel& model, int foot_link) {
  const Robot& robot = model.model().robot;
  std::vector<Eigen::Isometry3d> zero;
  model.pose(std::vector<double>(static_cast<size_t>(model.model().kinematics.column_count()), 0.0),
             zero);
  const std::vector<bool> of_foot = branch_of(robot, foot_link);

  std::vector<Vector2d> outline;
  for (const Part& part : model.model().parts) {
    if (!of_foot[static_cast<size_t>(part.link)]) continue;
    for (const Eigen::Vector3f& vertex : part.mesh.vertices) {
      foot_.push_back(zero[static_cast<size_t>(part.link)] * vertex.cast<double>() - ankle_);
      outline.push_back(sagittal(foot_.back()));
    }
  }
  double arc = 0;
  for (const Vector2d& point : lower_hull(std::move(outline))) {
    if (!sole_.empty()) arc += (point - sole_.back().position).norm();
    sole_.push_back({point, arc});
  }
  const auto lowest = std::min_element(
      sole_.begin(), sole_.end(),
      [](const SolePoint& a, const SolePoint& b) { return a.position.y() < b.position.y(); });
  if (lowest == sole_.end()) return;
  const double origin = lowest->arc - lowest->position.x();
  for (SolePoint& point : sole_) point.arc -= origin;
}

double Leg::reach_m(double knee_flexion_rad) const {
  const double in_plane = (thigh_ + turned(shank_, knee_flexion_rad)).norm();
  return length_of(in_plane, sideways_);
}

Leg::Rolled Leg::rolled(double pitch_rad) const {
  // Without sliding, the contact moves along the sole as far as along the ground; the ankle is
  // where the turned foot puts it over that contact. sole_ measures arc so that roll_m(0) is 0.
  double lowest = std::numeric_limits<double>::infinity(), ankle_x = 0;
  for (const SolePoint& point : sole_) {
    const Vector2d p = turned(point.position, -pitch_rad);
    if (p.y() >= lowest) continue;
    lowest = p.y();
    ankle_x = point.arc - p.x();
  }
  return {ankle_x, -lowest};
}

// Columns: forward along the heading, the knee's axis, and up in the plane that the leg bends in.
// The plane holds the heading and, but for the ankle's sideways offset, hip and ankle.
Matrix3d Leg::plane_frame(const Vector3d& hip_m, const FootTarget& target) const {
  const SinCos heading = sin_cos(target.heading_rad);
  const Vector3d forward(heading.cos, heading.sin, 0);
  const Vector3d left(-forward.y(), forward.x(), 0);
  const Vector3d leg = target.ankle_m - hip_m;
  const double y = leg.dot(left), z = leg.z();
  const double tilt = arc_tan2(z, y) + arc_cos(std::clamp(sideways_ / length_of(y, z), -1.0, 1.0));
  Matrix3d frame;
  frame.col(0) = forward;
  const SinCos tilted = sin_cos(tilt);
  frame.col(1) = tilted.cos * left + tilted.sin * Vector3d::UnitZ();
  frame.col(2) = forward.cross(frame.col(1));
  return frame;
}

Vector3d Leg::ankle_over_ground_m(const Vector3d& hip_m, const FootTarget& target) const {
  const Matrix3d frame = plane_frame(hip_m, target);
  const Eigen::RowVector3d heights = (frame * turn_y(-target.pitch_rad)).row(2);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vector3d& point : foot_) lowest = std::min(lowest, heights.dot(point));
  return frame.col(2) * (-lowest / frame(2, 2));
}

void Leg::solve(const Eigen::Isometry3d& pelvis, const FootTarget& target,
                std::vector<double>& columns) const {
  const Vector3d hip = pelvis * hip_;
  const Matrix3d frame = plane_frame(hip, target);
  const Vector2d reach = sagittal(frame.transpose() * (target.ankle_m - hip));

  // Law of cosines for links that need not be straight in the zero posture.
  const double wanted = (reach.squaredNorm() - thigh_.squaredNorm() - shank_.squaredNorm()) / 2;
  const double straight = angle_from(shank_, thigh_);
  const double knee =
      straight + arc_cos(std::clamp(wanted / (thigh_.norm() * shank_.norm()), -1.0, 1.0));
  const double thigh_turn = angle_from(thigh_ + turned(shank_, knee), reach);
  const double ankle = -target.pitch_rad - thigh_turn - knee;

  // R = turn(a1, q1) turn(a2, q2) turn(a3, q3) over perpendicular axes of either handedness.
  const Matrix3d r = pelvis.linear().transpose() * frame * turn_y(thigh_turn);
  const Vector3d &a1 = hip_axes_[0].direction, &a2 = hip_axes_[1].direction,
                 &a3 = hip_axes_[2].direction;
  const double hand = a1.dot(a2.cross(a3)) > 0 ? 1 : -1;
  const Vector3d end = r * a3, start = r.transpose() * a1;
  columns[static_cast<size_t>(hip_axes_[0].column)] = arc_tan2(a1.cross(a3).dot(end), a3.dot(end));
  columns[static_cast<size_t>(hip_axes_[1].column)] =
      arc_sin(std::clamp(hand * a1.dot(end), -1.0, 1.0));
  columns[static_cast<size_t>(hip_axes_[2].column)] =
      -arc_tan2(a3.cross(a1).dot(start), a1.dot(start));
  columns[static_cast<size_t>(knee_axis_.column)] = knee * knee_axis_.direction.y();
  columns[static_cast<size_t>(ankle_axis_.column)] = ankle * ankle_axis_.direction.y();
}

}  // namespace throng
