#include "avatars/gait/gait_cycle.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "avatars/gait/gait_curves.h"
#include "base/elementary.h"

namespace throng {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kToeOut = 6 * kDegree;
// Beyond the model's own hang of the arms, so that hands pass the thighs.
constexpr double kArmsOut = 1 * kDegree;
// Height of the lowest sole point at its highest in the swing, in leg lengths; 2.5 cm for an adult.
constexpr double kClearance = 0.029;
// Walking feet land nearer to the line of travel than the hips are apart (step width about 0.1 m).
constexpr double kStepWidthShare = 0.62;

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

}  // namespace

// One foot over the cycle, seen from above and from the side.
struct Walker::Step {
  const GaitCurves* curves;
  const Leg* leg;
  double stride_m, stance, swing_height_m, side_m, heading_rad;

  // The point under the ankle, in the root frame; the foot rolls along its heading and nowhere
  // else.
  Vector2d planted(double t) const {
    const double roll = leg->roll_m(curves->foot_pitch(t));
    return Vector2d(stride_m * (stance / 2 - t), side_m) +
           roll * Vector2d(sin_cos(heading_rad).cos, sin_cos(heading_rad).sin);
  }

  // Cubic. The foot leaves with the rolling foot's speed and lands with a part of it: at all of it
  // the foot would reach 5 cm too far first.
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

  // The share of the body's weight on this foot.
  double load(double t) const {
    const double shared = stance - 0.5;
    return smooth(t / shared) * smooth((stance - t) / shared);
  }
};

// A moment of the cycle before the pelvis's height is known.
struct Walker::Instant {
  std::vector<double> columns;
  Isometry3d pelvis;  // its motion from the zero posture
  struct Foot {
    Vector3d track_m;  // on the ground under the ankle
    double clearance_m, load, knee_rad;
    FootTarget target;
  };
  std::array<Foot, 2> feet;
  double shift_m = 0;  // of both tracks, forward
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
  // The pelvis is what both legs hang from: the parent of the first joint of a hip.
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

// Where a concave function is highest, by golden-section search.
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

// The rise and fall of a step, without its mean: the first harmonic, so that the body does not
// jerk.
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

// Height of a hip whose leg reaches `reach` to an ankle.
double hip_height(const Vector3d& hip, const Vector3d& ankle, double reach) {
  const double aside = (hip - ankle).head<2>().squaredNorm();
  return ankle.z() + std::sqrt(std::max(0.0, reach * reach - aside));
}

// A leg as what keeps the pelvis from rising: from the hip, without its height, to the ankle.
struct Rope {
  Vector3d ankle;
  double length;
};

// How far the pelvis can rise if all feet are moved forward by `shift`.
double highest_lift(const std::vector<Rope>& ropes, double shift) {
  double lift = std::numeric_limits<double>::infinity();
  for (const Rope& rope : ropes)
    lift = std::min(lift, hip_height(-shift * Vector3d::UnitX(), rope.ankle, rope.length));
  return lift;
}

}  // namespace

// Heights of pelvis and ankles and the places of the feet depend on each other, weakly, so they are
// found in turn. The feet are moved forward or back to where the legs allow the highest pelvis.
std::vector<double> Walker::fit_to_ground(const GaitCurves& curves,
                                          std::vector<Instant>& instants) const {
  const size_t n = instants.size();
  std::vector<double> height(n, 0.0), wanted(n), bob(n);
  for (int round = 0; round < 4; ++round) {
    for (size_t i = 0; i < n; ++i) {
      wanted[i] = 0;
      for (size_t side = 0; side < 2; ++side) {
        const Leg& leg = legs_[side];
        Instant::Foot& foot = instants[i].feet[side];
        const Vector3d hip = leg.hip_m(instants[i].pelvis);
        foot.target.ankle_m =
            foot.track_m + foot.clearance_m * Vector3d::UnitZ() +
            leg.ankle_over_ground_m(hip + height[i] * Vector3d::UnitZ(), foot.target);
        wanted[i] += foot.load *
                     (hip_height(hip, foot.target.ankle_m, leg.reach_m(foot.knee_rad)) - hip.z());
      }
    }
    bob = bob_of(wanted, curves.largest_bob() * leg_length_m());
    std::vector<Rope> ropes;
    for (size_t i = 0; i < n; ++i)
      for (size_t side = 0; side < 2; ++side)
        ropes.push_back({instants[i].feet[side].target.ankle_m -
                             (legs_[side].hip_m(instants[i].pelvis) + bob[i] * Vector3d::UnitZ()),
                         legs_[side].reach_m(kStraightestKnee_rad)});
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
  const StyleFigures& figures = curves.style();
  const double root_speed = std::sqrt(relative_speed);
  const double walking = smooth(root_speed);

  std::array<Step, 2> steps;
  for (size_t side = 0; side < 2; ++side) {
    const Leg& leg = legs_[side];
    const double width = 1 - walking * (1 - figures.step_width * kStepWidthShare);
    const double toes_out = kToeOut + walking * figures.toes_out_deg * kDegree;
    steps[side] = {&curves,
                   &leg,
                   stride_per_root_speed(style_) * root_speed * leg_length_m(),
                   stance_fraction(relative_speed, style_),
                   figures.lift * kClearance * std::min(root_speed, 1.0) * leg_length_m(),
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
