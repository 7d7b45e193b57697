#include "avatars/body_avoidance/outline.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "avatars/gait/gait_curves.h"
#include "base/files/archive.h"
#include "base/portable_math.h"

namespace throng {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// A straight arm slightly in front of the hip, as near to it as possible.
constexpr std::array<double, AvoidanceColumns::kArmJoints> kTucked_rad = {0, -3 * kDegree,
                                                                          3 * kDegree, 0};
constexpr float kMaxHeadYaw_rad = 0.5f;  // Gait::kMaxHeadYaw_rad

std::optional<AvoidanceColumns> columns_of(const PosableModel& model) {
  const auto column = [&model](const std::string& joint) {
    const int index = model.joint_of(joint);
    return index < 0 ? -1 : model.column_of_joint(index);
  };
  const auto limits = [&model](int c) {
    return model.model().kinematics.columns()[static_cast<size_t>(c)];
  };
  AvoidanceColumns columns;
  columns.trunk = column("thorax_yaw");
  if (columns.trunk < 0) return {};
  columns.min_trunk_rad = limits(columns.trunk).lower;
  columns.max_trunk_rad = limits(columns.trunk).upper;
  if (const int yaw_joint = model.head_yaw_joint(); yaw_joint >= 0) {
    columns.head = model.column_of_joint(yaw_joint);
    columns.min_head_rad = limits(columns.head).lower;
    columns.max_head_rad = limits(columns.head).upper;
    // Limits the trunk: the head counters its rotation and must stay within kMaxHeadYaw_rad.
    columns.min_trunk_rad =
        std::max(columns.min_trunk_rad, -columns.max_head_rad - kMaxHeadYaw_rad);
    columns.max_trunk_rad = std::min(columns.max_trunk_rad, kMaxHeadYaw_rad - columns.min_head_rad);
  }
  for (size_t side = 0; side < 2; ++side) {
    const std::string name = side == 0 ? "right_" : "left_";
    size_t i = 0;
    for (const char* joint :
         {"shoulder_flexion", "shoulder_abduction", "elbow_flexion", "wrist_flexion"}) {
      const int c = column(name + joint);
      if (c < 0) return {};
      columns.arms[side][i] = c;
      columns.tucked_rad[side][i] = static_cast<float>(model.clamped(c, kTucked_rad[i]));
      columns.min_arm_rad[side][i] = limits(c).lower;
      columns.max_arm_rad[side][i] = limits(c).upper;
      ++i;
    }
  }
  return columns;
}

/// Returns the extreme vertices in 26 directions, which stand for a part.
std::vector<Vector3d> outermost(const Part& part) {
  std::vector<Vector3d> points;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const Eigen::Vector3f direction(static_cast<float>(x), static_cast<float>(y),
                                        static_cast<float>(z));
        const Eigen::Vector3f* farthest = nullptr;
        for (const Eigen::Vector3f& vertex : part.mesh.vertices)
          if (farthest == nullptr || vertex.dot(direction) > farthest->dot(direction))
            farthest = &vertex;
        if (farthest != nullptr) points.push_back(farthest->cast<double>());
      }
  return points;
}

/// Arms are the parts below the elbow.
enum class Region { kElse, kTrunk, kUpperArm, kRightArm, kLeftArm, kRightThigh, kLeftThigh };

std::vector<Region> regions_of(const PosableModel& model, const AvoidanceColumns& columns) {
  const Robot& robot = model.model().robot;
  std::vector<Region> regions(robot.links.size(), Region::kElse);
  for (size_t j = 0; j < robot.joints.size(); ++j) {  // parents first
    const Joint& joint = robot.joints[j];
    Region& region = regions[static_cast<size_t>(joint.child_link)];
    const int column = model.column_of_joint(static_cast<int>(j));
    region = regions[static_cast<size_t>(joint.parent_link)];
    if (column < 0) continue;
    for (const bool is_left : {false, true}) {
      const std::string side = is_left ? "left_" : "right_";
      if (joint.name == side + "hip_flexion")
        region = is_left ? Region::kLeftThigh : Region::kRightThigh;
      if (joint.name == side + "knee_flexion") region = Region::kElse;
    }
    if (column == columns.trunk) region = Region::kTrunk;
    constexpr size_t kElbow = 2;
    for (size_t side = 0; side < 2; ++side) {
      if (column == columns.arms[side][0]) region = Region::kUpperArm;
      if (column == columns.arms[side][kElbow])
        region = side == 0 ? Region::kRightArm : Region::kLeftArm;
    }
  }
  return regions;
}

/// Extends an arm's sweep to any tuck: tucking may increase the reach, see arm_reach().
Octagon at_any_tuck(Octagon sweep, const Octagon& tucked) {
  const float farther_m = std::max(
      {tucked.reaches_m[2] - sweep.reaches_m[2], tucked.reaches_m[6] - sweep.reaches_m[6], 0.0f});
  constexpr float kDiagonal = 0.7072f;
  for (float& reach_m : sweep.reaches_m) reach_m += kDiagonal * farther_m;
  return sweep;
}

struct Shape {
  Region region;
  size_t link;
  std::vector<Vector3d> points;
};

}  // namespace

void RadialProfile::add(double x, double y) {
  static const std::array<SinCos, kDirections> directions = [] {
    std::array<SinCos, kDirections> all;
    for (size_t i = 0; i < all.size(); ++i)
      all[i] = sin_cos(static_cast<double>(i) * (2 * 3.14159265358979323846 / kDirections));
    return all;
  }();
  for (size_t i = 0; i < directions.size(); ++i)
    reach_m_[i] =
        std::max(reach_m_[i], static_cast<float>(directions[i].cos * x + directions[i].sin * y));
}

void RadialProfile::close() {
  constexpr float kGrain = 1.0f / 8192;
  for (int i = 0; i < kDirections; ++i) reach_m_[i] = std::nearbyint(reach_m_[i] / kGrain) * kGrain;
  for (int i = 0; i < kWrapped; ++i) reach_m_[kDirections + i] = reach_m_[i];
  max_m_ = *std::max_element(reach_m_, reach_m_ + kDirections);
}

void Octagon::add(double x, double y) {
  constexpr double kDiagonal = 0.70710678118654752;
  const double along = kDiagonal * (x + y), across = kDiagonal * (y - x);
  const std::array<double, 8> reaches = {x, along, y, across, -x, -along, -y, -across};
  for (size_t i = 0; i < reaches.size(); ++i)
    reaches_m[i] = std::max(reaches_m[i], static_cast<float>(reaches[i]));
}

void Octagon::add(const Octagon& other) {
  for (size_t i = 0; i < reaches_m.size(); ++i)
    reaches_m[i] = std::max(reaches_m[i], other.reaches_m[i]);
}

void LimbOutlines::add(const LimbOutlines& other) {
  for (size_t side = 0; side < 2; ++side) {
    arms[side].add(other.arms[side]);
    thighs[side].add(other.thighs[side]);
  }
}

MaxExtent::MaxExtent(const Octagon& octagon) {
  const std::array<float, 8>& r = octagon.reaches_m;
  ahead_m = std::max(r[0], r[4]);
  oblique_m = std::max({r[1], r[3], r[5], r[7]});
  aside_m = std::max(r[2], r[6]);
  for (const float side_m : {ahead_m, aside_m})
    max_m = std::max(max_m, std::hypot(side_m, 1.41421356f * oblique_m - side_m));
}

LimbSweep::LimbSweep(const Outline& outline, const std::array<LimbOutlines, kPhases>& boxes,
                     float sway_m)
    : outline_(&outline), boxes_(boxes), sway_m_(sway_m) {
  for (size_t phase = 0; phase < kPhases; ++phase) {
    boxes_[phase].add(boxes[(phase + 1) % kPhases]);
    boxes_[phase].add(boxes[(phase + kPhases - 1) % kPhases]);
    envelope_.add(boxes[phase]);
  }
  Octagon all;
  for (size_t direction = 0; direction < all.reaches_m.size(); ++direction)
    all.reaches_m[direction] = outline.upper.from(0)[direction * RadialProfile::kDirections / 8];
  for (const LimbOutlines& limbs : boxes_)
    for (size_t side = 0; side < 2; ++side) {
      all.add(limbs.thighs[side]);
      all.add(at_any_tuck(limbs.arms[side], outline.tucked[side]));
    }
  max_extent_ = MaxExtent(all);
}

void AvoidanceColumns::archive(Archive& a) {
  a(trunk, head, arms, tucked_rad, min_arm_rad, max_arm_rad, min_trunk_rad, max_trunk_rad,
    min_head_rad, max_head_rad);
}

void RadialProfile::archive(Archive& a) { a(reach_m_, max_m_); }

void Octagon::archive(Archive& a) { a(reaches_m); }

void LimbOutlines::archive(Archive& a) { a(arms, thighs); }

void MaxExtent::archive(Archive& a) { a(ahead_m, oblique_m, aside_m, max_m); }

void LimbSweep::archive(Archive& a) { a(boxes_, envelope_, max_extent_, sway_m_); }

void Outline::archive(Archive& a) {
  a(columns, upper, tucked, per_sqrt_speed, leg_length_m);
  for (std::vector<LimbSweep>* all : {&sweeps, &standing}) {
    auto count = static_cast<uint32_t>(all->size());
    a(count);
    while (all->size() < count)
      all->emplace_back(*this, std::array<LimbOutlines, LimbSweep::kPhases>{}, 0.0f);
    for (LimbSweep& swing : *all) a(swing);
  }
}

const LimbSweep& Outline::sweep_at(float speed_mps, float scale) const {
  const float root = std::sqrt(std::max(speed_mps, 0.0f) / (leg_length_m * scale));
  const float after_half = root * per_sqrt_speed + 0.5f;
  return sweeps[std::min(static_cast<size_t>(after_half), sweeps.size() - 1)];
}

std::unique_ptr<const Outline> outline_of(const PosableModel& model, const GaitTable& table,
                                          float cells_per_sqrt_speed, float leg_length_m) {
  const std::optional<AvoidanceColumns> columns = columns_of(model);
  if (!columns) return nullptr;
  auto outline = std::make_unique<Outline>();
  outline->columns = *columns;
  outline->per_sqrt_speed = cells_per_sqrt_speed;
  outline->leg_length_m = leg_length_m;
  const int trunk = model.joint_of("thorax_yaw");
  const auto trunk_link =
      static_cast<size_t>(model.model().robot.joints[static_cast<size_t>(trunk)].child_link);
  const std::vector<Region> regions = regions_of(model, *columns);
  std::vector<Shape> shapes;
  for (const Part& part : model.model().parts)
    shapes.push_back(
        {regions[static_cast<size_t>(part.link)], static_cast<size_t>(part.link), outermost(part)});

  // Visits the model's points in the axes of `along`, from the axis that the trunk turns about.
  std::vector<Isometry3d> links;
  const auto visit = [&](const std::vector<double>& posture, const auto& along, const auto& add) {
    model.pose(posture, links);
    const Isometry3d from_root = along(links[trunk_link]).inverse();
    for (const Shape& shape : shapes) {
      const Isometry3d pose = from_root * links[shape.link];
      for (const Vector3d& point : shape.points) add(shape.region, Vector3d(pose * point));
    }
  };
  const auto trunk_axes = [](const Isometry3d& trunk_pose) { return trunk_pose; };
  const auto heading_axes = [](const Isometry3d& trunk_pose) {
    return Isometry3d(Eigen::Translation3d(trunk_pose.translation()));
  };
  const auto boxes_of = [&](const std::vector<double>& posture, const auto& along) {
    LimbOutlines boxes;
    visit(posture, along, [&](Region region, const Vector3d& p) {
      if (region == Region::kRightArm) boxes.arms[0].add(p.x(), p.y());
      if (region == Region::kLeftArm) boxes.arms[1].add(p.x(), p.y());
      if (region == Region::kRightThigh) boxes.thighs[0].add(p.x(), p.y());
      if (region == Region::kLeftThigh) boxes.thighs[1].add(p.x(), p.y());
    });
    return boxes;
  };
  std::vector<double> tucked = model.rest();
  for (size_t side = 0; side < 2; ++side)
    for (size_t i = 0; i < AvoidanceColumns::kArmJoints; ++i)
      tucked[static_cast<size_t>(columns->arms[side][i])] =
          static_cast<double>(columns->tucked_rad[side][i]);
  visit(tucked, trunk_axes, [&](Region region, const Vector3d& p) {
    if (region != Region::kElse && region != Region::kRightThigh && region != Region::kLeftThigh)
      outline->upper.add(p.x(), p.y());
  });
  outline->upper.close();
  outline->tucked = boxes_of(tucked, trunk_axes).arms;
  const auto row = [&table](int speed, int phase) {
    const float* from = table.row(speed, phase);
    return std::vector<double>(from, from + table.columns);
  };
  const int aside = model.joint_of("pelvis_lateral");
  for (int speed = 0; speed < table.speeds; ++speed) {
    std::array<LimbOutlines, LimbSweep::kPhases> boxes;
    double sway_m = 0;
    for (int phase = 0; phase < LimbSweep::kPhases; ++phase) {
      const std::vector<double> posture = row(speed, phase * table.phases / LimbSweep::kPhases);
      boxes[static_cast<size_t>(phase)] = boxes_of(posture, heading_axes);
      if (aside >= 0)  // projection on a sine from GaitCurves::kSwayPhase on
        sway_m -= posture[static_cast<size_t>(model.column_of_joint(aside))] *
                  (2.0 / LimbSweep::kPhases) *
                  sin_cos(kTurn * (static_cast<double>(phase) / LimbSweep::kPhases -
                                   GaitCurves::kSwayPhase))
                      .sin;
    }
    outline->sweeps.emplace_back(*outline, boxes, static_cast<float>(sway_m));
  }
  const float* const still = table.row(0, 0);
  for (size_t hold = 0; hold < kArmHoldCount; ++hold)
    for (const bool is_mirrored : {false, true}) {
      std::vector<float> posture(still, still + table.columns);
      apply_standing_arms(*columns, mean_standing_posture(static_cast<ArmHold>(hold), is_mirrored),
                          1, posture);
      std::array<LimbOutlines, LimbSweep::kPhases> boxes;
      boxes.fill(boxes_of({posture.begin(), posture.end()}, heading_axes));
      outline->standing.emplace_back(*outline, boxes, 0.0f);
    }
  return outline;
}

}  // namespace throng
