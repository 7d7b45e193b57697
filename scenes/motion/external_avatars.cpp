#include "scenes/motion/external_avatars.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "crowd/crowd.h"

namespace throng {
namespace {

double nearest(double value, double last, double low, double high, int& clamped) {
  if (value >= low && value <= high) return value;
  ++clamped;
  return std::isnan(value) ? last : std::clamp(value, low, high);
}

Eigen::Quaternionf unit_of(const Eigen::Quaternionf& turn, const Eigen::Quaternionf& last,
                           int& clamped) {
  // A pose sent back unchanged stays bitwise equal.
  if (turn.coeffs() == last.coeffs()) return last;
  // In double: the square of a large float overflows.
  Eigen::Quaterniond q = turn.cast<double>();
  const double length = q.norm();
  if (std::isfinite(length) && length > 1e-6) {
    q.coeffs() /= length;
    return q.cast<float>();
  }
  ++clamped;
  return last;
}

}  // namespace

ExternalPose clamped_pose(const ExternalPose& pose, const ExternalPose& last,
                          const Rectangle& ground, int& clamped) {
  ExternalPose out = pose;
  Eigen::Vector3d& p = out.root.position_m;
  const Eigen::Vector3d& from = last.root.position_m;
  p.x() = nearest(p.x(), from.x(), ground.min_m.x(), ground.max_m.x(), clamped);
  p.y() = nearest(p.y(), from.y(), ground.min_m.y(), ground.max_m.y(), clamped);
  p.z() = nearest(p.z(), from.z(), -kMaxExternalHeight_m, kMaxExternalHeight_m, clamped);
  out.root.world_from_root = unit_of(pose.root.world_from_root, last.root.world_from_root, clamped);
  const double speed = out.velocity_mps.norm();
  if (!(speed <= kMaxExternalSpeed_mps)) {
    ++clamped;
    out.velocity_mps = std::isfinite(speed)
                           ? Eigen::Vector2d(out.velocity_mps * (kMaxExternalSpeed_mps / speed))
                           : last.velocity_mps;
  }
  return out;
}

void write_row(std::span<const double> joints, const FlatModel& kinematics, std::span<float> row,
               int& clamped) {
  assert(joints.size() == row.size());
  for (size_t i = 0; i < row.size(); ++i) {
    const JointColumn& column = kinematics.columns()[i];
    // Limits are floats: a double just inside may round to a float outside.
    const bool goes_round =
        !column.prismatic && static_cast<double>(column.upper) - static_cast<double>(column.lower) >
                                 2 * std::numbers::pi - 1e-5;
    const double turned = goes_round ? std::remainder(joints[i], 2 * std::numbers::pi) : joints[i];
    const double value =
        nearest(turned, static_cast<double>(row[i]), static_cast<double>(column.lower),
                static_cast<double>(column.upper), clamped);
    row[i] = std::clamp(static_cast<float>(value), column.lower, column.upper);
  }
}

void ExternalAvatars::add(uint32_t avatar, const FlatModel& kinematics, const RootPose& root) {
  assert(all_.empty() || all_.back().avatar < avatar);
  places_.resize(avatar, kNone);
  places_.push_back(static_cast<uint32_t>(all_.size()));
  ExternalAvatar& one = all_.emplace_back();
  one.avatar = avatar;
  one.kinematics = &kinematics;
  one.pose.root = root;
  for (const JointColumn& column : kinematics.columns())
    one.row.push_back(std::clamp(0.0f, column.lower, column.upper));
}

void ExternalAvatars::archive(Archive& a) {
  for (ExternalAvatar& one : all_) {
    RootPose& root = one.pose.root;
    a(root.position_m, root.world_from_root, one.pose.velocity_mps, one.pose.walks, one.row);
    // Negated comparison: also rejects NaN.
    bool is_possible = root.position_m.allFinite() &&
                       std::abs(root.world_from_root.norm() - 1) < 1e-3F &&
                       one.pose.velocity_mps.norm() <= kMaxExternalSpeed_mps * (1 + 1e-9);
    for (size_t i = 0; i < one.row.size(); ++i) {
      const JointColumn& column = one.kinematics->columns()[i];
      is_possible = is_possible && one.row[i] >= column.lower && one.row[i] <= column.upper;
    }
    if (!is_possible)
      a.reject("a possible pose of an externally controlled avatar", "an impossible one");
  }
}

const ExternalAvatars::ExternalAvatar* ExternalAvatars::find(uint32_t avatar) const {
  if (avatar >= places_.size() || places_[avatar] == kNone) return nullptr;
  return &all_[places_[avatar]];
}

const ExternalPose* ExternalAvatars::pose(uint32_t avatar) const {
  const ExternalAvatar* found = find(avatar);
  return found == nullptr ? nullptr : &found->pose;
}

int ExternalAvatars::set_pose(uint32_t avatar, const ExternalPose& pose, const Rectangle& ground) {
  const ExternalAvatar* known = find(avatar);
  if (known == nullptr) return -1;
  ExternalAvatar* found = &all_[static_cast<size_t>(known - all_.data())];
  if (!pose.joints.empty() && pose.joints.size() != found->row.size()) return -1;
  int clamped = 0;
  found->pose = clamped_pose(pose, found->pose, ground, clamped);
  found->pose.joints = {};
  if (!pose.joints.empty()) write_row(pose.joints, *found->kinematics, found->row, clamped);
  return clamped;
}

void ExternalAvatars::apply_external(Crowd& crowd) const {
  for (const ExternalAvatar& one : all_) {
    const Eigen::Vector3f ahead = one.pose.root.world_from_root * Eigen::Vector3f::UnitX();
    Eigen::Vector2d heading = ahead.head<2>().cast<double>();
    // An avatar that points straight up has no heading; it keeps the last one.
    if (heading.norm() > 1e-3)
      heading.normalize();
    else
      heading = crowd.headings()[one.avatar];
    crowd.override_motion(one.avatar, one.pose.root.position_m.head<2>(), heading,
                          one.pose.velocity_mps);
  }
}

void ExternalAvatars::stop_walking() {
  for (ExternalAvatar& one : all_)
    if (one.pose.walks) one.pose.velocity_mps.setZero();
}

void ExternalAvatars::place(std::span<RootPose> roots) const {
  for (const ExternalAvatar& one : all_)
    if (!one.pose.walks) roots[one.avatar] = one.pose.root;
}

void ExternalAvatars::bind_rows(std::span<const float*> rows) const {
  for (const ExternalAvatar& one : all_)
    rows[one.avatar] = one.pose.walks ? nullptr : one.row.data();
}

}  // namespace throng
