#include "avatars/gait/gait_cycle.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "avatars/gait/gait_curves.h"
#include "base/portable_math.h"

namespace throng {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Tolerance for joints of a leg to meet and be perpendicular, as the closed form requires.
constexpr double kSquare = 1e-3;

Matrix3d turn_y(double angle) { return turn_about(Vector3d::UnitY(), angle); }

Vector2d sagittal(const Vector3d& v) { return {v.x(), v.z()}; }

// Returns (x, z) turned by `angle` about +y, toes down.
Vector2d turned(const Vector2d& v, double angle) {
  const auto [s, c] = sin_cos(angle);
  return {c * v.x() + s * v.y(), c * v.y() - s * v.x()};
}

double angle_from(const Vector2d& from, const Vector2d& to) {
  const Vector2d quarter(from.y(), -from.x());
  return arc_tan2(quarter.dot(to), from.dot(to));
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Returns the lower convex hull from left to right (Andrew 1979).
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
  struct HipJoint {
    int joint;
    Axis axis;
    Vector3d origin;
  };
  std::vector<HipJoint> chain;
  for (const std::string& name : names) {
    const int joint = model.joint_of(side + name);
    if (joint < 0 || model.column_of_joint(joint) < 0) return std::nullopt;
    const Joint& j = robot.joints[static_cast<size_t>(joint)];
    if (j.kind == Joint::Kind::kPrismatic || j.mimic) return std::nullopt;
    const Eigen::Isometry3d& frame = zero[static_cast<size_t>(j.child_link)];
    chain.push_back(
        {joint, {frame.linear() * j.axis, model.column_of_joint(joint)}, frame.translation()});
  }
  // Joints are stored parents first: URDF order is chain order.
  std::sort(chain.begin(), chain.begin() + 3,
            [](const HipJoint& a, const HipJoint& b) { return a.joint < b.joint; });

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

// Returns which links hang from `link`, itself included, without the branch at `end`.
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
      // Geometry between the hip's axes turns about the hip alone.
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
  // Half width of the sole that a flat foot stands on.
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
  // Without sliding, the contact moves equally far along the sole and along the ground. The turned
  // foot places the ankle over that contact. sole_ measures arc such that roll_m(0) is 0.
  double lowest = std::numeric_limits<double>::infinity(), ankle_x = 0;
  for (const SolePoint& point : sole_) {
    const Vector2d p = turned(point.position, -pitch_rad);
    if (p.y() >= lowest) continue;
    lowest = p.y();
    ankle_x = point.arc - p.x();
  }
  return {ankle_x, -lowest};
}

// Columns: forward along the heading, the knee's axis, and up in the plane in which the leg bends.
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

  // Cosine rule for links that need not be straight in the zero posture.
  const double required = (reach.squaredNorm() - thigh_.squaredNorm() - shank_.squaredNorm()) / 2;
  const double straight = angle_from(shank_, thigh_);
  const double knee =
      straight + arc_cos(std::clamp(required / (thigh_.norm() * shank_.norm()), -1.0, 1.0));
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

namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kToeOut = 6 * kDegree;
// Added to the hang of the model's arms to let hands pass the thighs.
constexpr double kArmsOut = 1 * kDegree;
// Maximum height of the lowest sole point in swing, in leg lengths; 2.5 cm for an adult.
constexpr double kClearance = 0.029;
// Walking feet land nearer to the line of travel than the hips are apart (step width about 0.1 m).
constexpr double kStepWidthShare = 0.62;

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

}  // namespace

struct Walker::Step {
  const GaitCurves* curves;
  const Leg* leg;
  double stride_m, stance, swing_height_m, side_m, heading_rad;

  // Returns the point under the ankle, in the root frame. The foot rolls along its heading only.
  Vector2d planted(double t) const {
    const double roll = leg->roll_m(curves->foot_pitch(t));
    return Vector2d(stride_m * (stance / 2 - t), side_m) +
           roll * Vector2d(sin_cos(heading_rad).cos, sin_cos(heading_rad).sin);
  }

  // Cubic. The foot lands with a share of the rolling speed; at all of it, it overshoots by 5 cm.
  Vector2d swing(double t) const {
    constexpr double kDt = 1e-5, kLandingShare = 0.35;
    const double span = 1 - stance, u = (t - stance) / span, v = 1 - u;
    const Vector2d leave = planted(stance), land = planted(0);
    const Vector2d leave_rate = (leave - planted(stance - kDt)) * (span / kDt);
    const Vector2d land_rate = (planted(kDt) - land) * (span / kDt * kLandingShare);
    return leave * (v * v * (1 + 2 * u)) + leave_rate * (u * v * v) + land * (u * u * (1 + 2 * v)) -
           land_rate * (u * u * v);
  }

  Vector3d track(double t) const {
    Vector3d point = Vector3d::Zero();
    point.head<2>() = t <= stance ? planted(t) : swing(t);
    return point;
  }

  double clearance_m(double t) const {
    const double u = std::max(0.0, t - stance) / (1 - stance), v = 1 - u;
    return swing_height_m * (u * u * v * v * v) / (0.4 * 0.4 * 0.6 * 0.6 * 0.6);
  }

  double load(double t) const {
    const double shared = stance - 0.5;
    return smooth(t / shared) * smooth((stance - t) / shared);
  }
};

struct Walker::Instant {
  std::vector<double> columns;
  Isometry3d pelvis;  // relative to the zero posture
  struct Foot {
    Vector3d track_m;  // on the ground under the ankle
    double clearance_m, load, knee_rad;
    FootTarget target;
  };
  std::array<Foot, 2> feet;
  double shift_m = 0;  // shift of both tracks, forward
};

std::optional<Walker> Walker::find(const PosableModel& model, GaitStyle style) {
  std::optional<Leg> right = Leg::find(model, "right"), left = Leg::find(model, "left");
  const int vertical = model.joint_of("pelvis_vertical");
  if (!right || !left || vertical < 0 || model.column_of_joint(vertical) < 0) return std::nullopt;
  Walker walker(model, style, std::move(*right), std::move(*left));
  const Robot& robot = model.model().robot;
  std::vector<Isometry3d> zero;
  model.pose(std::vector<double>(static_cast<size_t>(model.model().kinematics.column_count()), 0.0),
             zero);
  const Joint& lift = robot.joints[static_cast<size_t>(vertical)];
  const Vector3d up = zero[static_cast<size_t>(lift.child_link)].linear() * lift.axis;
  if (lift.kind != Joint::Kind::kPrismatic || up.z() < 1 - 1e-6) return std::nullopt;
  walker.vertical_column_ = model.column_of_joint(vertical);
  // The pelvis is the link from which both legs hang: the parent of the first joint of a hip.
  for (size_t side = 0; side < 2; ++side) {
    const std::string name = side == 0 ? "right" : "left";
    int first_hip = std::numeric_limits<int>::max();
    for (const char* axis : {"_hip_flexion", "_hip_adduction", "_hip_rotation"})
      first_hip = std::min(first_hip, model.joint_of(name + axis));
    const Joint& hip = robot.joints[static_cast<size_t>(first_hip)];
    walker.leg_links_[side] = hip.child_link;
    if (side == 0) walker.pelvis_link_ = hip.parent_link;
  }
  walker.pelvis_from_root_ = zero[static_cast<size_t>(walker.pelvis_link_)].inverse();
  return walker;
}

void Walker::set(std::vector<double>& columns, const std::string& joint, double value) const {
  const int column = model_->model().kinematics.column_of(joint);
  if (column >= 0) columns[static_cast<size_t>(column)] = model_->clamped(column, value);
}

Walker::Instant Walker::instant(const GaitCurves& curves, const std::array<Step, 2>& steps,
                                double t) const {
  Instant now;
  std::vector<double>& columns = now.columns = model_->rest();
  set(columns, "pelvis_lateral", curves.pelvis_lateral(t) * leg_length_m());
  set(columns, "pelvis_forward", curves.pelvis_forward(t) * leg_length_m());
  set(columns, "pelvis_yaw", curves.pelvis_yaw(t));
  set(columns, "pelvis_pitch", curves.pelvis_pitch(t));
  set(columns, "pelvis_roll", curves.pelvis_roll(t));
  set(columns, "thorax_yaw", curves.thorax_yaw(t) - curves.pelvis_yaw(t));
  set(columns, "head_yaw", -curves.thorax_yaw(t));
  for (size_t side = 0; side < 2; ++side) {
    const std::string name = side == 0 ? "right" : "left";
    double own = t + 0.5 * static_cast<double>(side);
    own -= std::floor(own);
    set(columns, name + "_shoulder_flexion", curves.shoulder_flexion(own));
    set(columns, name + "_shoulder_abduction", kArmsOut + curves.style().arms_out_deg * kDegree);
    set(columns, name + "_elbow_flexion", curves.elbow_flexion(own));
    const Step& step = steps[side];
    now.feet[side] = {step.track(own),
                      step.clearance_m(own),
                      step.load(own),
                      curves.knee_flexion(own),
                      {Vector3d::Zero(), curves.foot_pitch(own), step.heading_rad}};
  }
  columns[static_cast<size_t>(vertical_column_)] = 0;
  std::vector<Isometry3d> links;
  model_->pose(columns, links);
  now.pelvis = links[static_cast<size_t>(pelvis_link_)] * pelvis_from_root_;
  return now;
}

namespace {

// Returns the argument of a concave function's maximum, by golden-section search.
template <typename Function>
double highest_point(const Function& value, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 25; ++i) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    if (value(a) > value(b))
      high = b;
    else
      low = a;
  }
  return (low + high) / 2;
}

// Returns the vertical oscillation of a step: the first harmonic; higher ones would jerk the body.
std::vector<double> bob_of(const std::vector<double>& samples, double largest) {
  const size_t n = samples.size();
  const auto angle = [n](size_t i) {
    return 2 * kTurn * static_cast<double>(i) / static_cast<double>(n);
  };
  double cosine = 0, sine = 0;
  for (size_t i = 0; i < n; ++i) {
    cosine += 2 * samples[i] * sin_cos(angle(i)).cos / static_cast<double>(n);
    sine += 2 * samples[i] * sin_cos(angle(i)).sin / static_cast<double>(n);
  }
  const double amplitude = length_of(cosine, sine);
  const double share = amplitude > largest ? largest / amplitude : 1;
  std::vector<double> bob(n);
  for (size_t i = 0; i < n; ++i)
    bob[i] = share * (cosine * sin_cos(angle(i)).cos + sine * sin_cos(angle(i)).sin);
  return bob;
}

double hip_height(const Vector3d& hip, const Vector3d& ankle, double reach) {
  const double aside = (hip - ankle).head<2>().squaredNorm();
  return ankle.z() + std::sqrt(std::max(0.0, reach * reach - aside));
}

// A leg as a limit on the pelvis's height: from the hip, without its height, to the ankle.
struct Rope {
  Vector3d ankle;
  double length;
};

// Returns how far the pelvis can rise if all feet are moved forward by `shift`.
double highest_lift(const std::vector<Rope>& ropes, double shift) {
  double lift = std::numeric_limits<double>::infinity();
  for (const Rope& rope : ropes)
    lift = std::min(lift, hip_height(-shift * Vector3d::UnitX(), rope.ankle, rope.length));
  return lift;
}

}  // namespace

// Pelvis, ankles and feet depend on each other weakly, hence the iteration. Feet are moved to where
// the legs allow the highest pelvis.
std::vector<double> Walker::fit_to_ground(const GaitCurves& curves,
                                          std::vector<Instant>& instants) const {
  const size_t n = instants.size();
  std::vector<double> height(n, 0.0), required(n), bob(n);
  for (int round = 0; round < 4; ++round) {
    for (size_t i = 0; i < n; ++i) {
      required[i] = 0;
      for (size_t side = 0; side < 2; ++side) {
        const Leg& leg = legs_[side];
        Instant::Foot& foot = instants[i].feet[side];
        const Vector3d hip = leg.hip_m(instants[i].pelvis);
        foot.target.ankle_m =
            foot.track_m + foot.clearance_m * Vector3d::UnitZ() +
            leg.ankle_over_ground_m(hip + height[i] * Vector3d::UnitZ(), foot.target);
        required[i] += foot.load *
                       (hip_height(hip, foot.target.ankle_m, leg.reach_m(foot.knee_rad)) - hip.z());
      }
    }
    bob = bob_of(required, curves.bob_amplitude() * leg_length_m());
    std::vector<Rope> ropes;
    for (size_t i = 0; i < n; ++i)
      for (size_t side = 0; side < 2; ++side)
        ropes.push_back({instants[i].feet[side].target.ankle_m -
                             (legs_[side].hip_m(instants[i].pelvis) + bob[i] * Vector3d::UnitZ()),
                         legs_[side].reach_m(kMinKneeBend_rad)});
    const auto highest = [&](double shift) { return highest_lift(ropes, shift); };
    const double shift = highest_point(highest, -0.3 * leg_length_m(), 0.3 * leg_length_m());
    const double lift = highest(shift);
    for (size_t i = 0; i < n; ++i) {
      height[i] = bob[i] + lift;
      instants[i].shift_m += shift;
      for (Instant::Foot& foot : instants[i].feet) {
        foot.track_m.x() += shift;
        foot.target.ankle_m.x() += shift;
      }
    }
  }
  return height;
}

std::vector<WalkerPose> Walker::cycle(double relative_speed, int n) const {
  assert(n > 0 && n % 2 == 0);
  const GaitCurves curves(relative_speed, style_);
  const StyleParameters& parameters = curves.style();
  const double sqrt_speed = std::sqrt(relative_speed);
  const double walking = smooth(sqrt_speed);

  std::array<Step, 2> steps;
  for (size_t side = 0; side < 2; ++side) {
    const Leg& leg = legs_[side];
    const double width = 1 - walking * (1 - parameters.step_width * kStepWidthShare);
    const double toes_out = kToeOut + walking * parameters.toes_out_deg * kDegree;
    steps[side] = {&curves,
                   &leg,
                   stride_per_sqrt_speed(style_) * sqrt_speed * leg_length_m(),
                   stance_fraction(relative_speed, style_),
                   parameters.lift * kClearance * std::min(sqrt_speed, 1.0) * leg_length_m(),
                   leg.ankle_m().y() * width,
                   side == 0 ? -toes_out : toes_out};
  }
  std::vector<Instant> instants;
  instants.reserve(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i)
    instants.push_back(instant(curves, steps, static_cast<double>(i) / n));

  const std::vector<double> height = fit_to_ground(curves, instants);

  std::vector<WalkerPose> poses;
  for (size_t i = 0; i < instants.size(); ++i) {
    WalkerPose pose;
    std::vector<double>& columns = pose.columns = instants[i].columns;
    const double allowed = model_->clamped(vertical_column_, height[i]);
    columns[static_cast<size_t>(vertical_column_)] = allowed;
    Isometry3d pelvis = instants[i].pelvis;
    pelvis.pretranslate(allowed * Vector3d::UnitZ());
    pose.root_from_pelvis = pelvis.linear();
    for (size_t side = 0; side < 2; ++side) {
      const Instant::Foot& foot = instants[i].feet[side];
      legs_[side].solve(pelvis, foot.target, columns);
      pose.feet[side] = {legs_[side].hip_m(pelvis),
                         foot.track_m + foot.clearance_m * Vector3d::UnitZ(), foot.target};
    }
    pose.shift_m = instants[i].shift_m;
    for (size_t c = 0; c < columns.size(); ++c)
      columns[c] = model_->clamped(static_cast<int>(c), columns[c]);
    poses.push_back(std::move(pose));
  }
  return poses;
}

}  // namespace throng
