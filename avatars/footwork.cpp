#include "avatars/footwork.h"

#include <algorithm>
#include <cmath>

#include "avatars/gait_curves.h"
#include "avatars/gait_math.h"
#include "kinematics/sin_cos.h"

namespace throng {
namespace {

// A step is taken when a planted foot is so far from where the gait would have it: the toes turn by
// 20 degrees, or the leg goes askew by a hand's length.
constexpr float kComfort_rad = 0.35f;
constexpr float kComfortShare = 0.12f;  // of the leg
// Cycles a second of such a step, and of one that is to be finished.
constexpr float kSteppingRate_hz = 1.1f;
constexpr float kFinishingRate_hz = 0.9f;
// The foot turns against the body no farther: the hip's own limit, less what walking takes.
constexpr float kMostTurn_rad = 0.6f;
// A foot that steps where the gait hardly lifts it clears the ground by so much.
constexpr float kLift_m = 0.03f;
// Nobody looks farther ahead for a landing place.
constexpr float kLongestLook_s = 0.9f;

float smooth(float u) { return u * u * (3 - 2 * u); }

float fraction(float phase) {
  const float wrapped = phase - std::floor(phase);
  return wrapped < 1 ? wrapped : 0;
}

float own_phase(float phase, int side) { return side == 0 ? phase : fraction(phase + 0.5f); }

float stance_of(float root_speed) {
  return 0.752f - 0.143f / static_cast<float>(kStridePerRootSpeed) * root_speed;
}

}  // namespace

Footwork::Footwork(const Walker& walker, const PosableModel& model,
                   std::span<const std::vector<WalkerPose>> poses_by_speed,
                   float cells_per_root_speed)
    : phases_(static_cast<int>(poses_by_speed.front().size())),
      speeds_(static_cast<int>(poses_by_speed.size())),
      cells_per_root_speed_(cells_per_root_speed),
      leg_length_m_(static_cast<float>(walker.leg_length_m())),
      vertical_column_(walker.vertical_column()) {
  // Rounded, so that the last bits of a C library's sines do not reach a result.
  constexpr double kGrain = 1.0 / (1 << 18);
  const auto grained = [](double value) {
    return static_cast<float>(std::nearbyint(value / kGrain) * kGrain);
  };
  double farthest = 0;
  for (const std::vector<WalkerPose>& poses : poses_by_speed)
    for (int phase = 0; phase <= phases_; ++phase) {
      const WalkerPose& pose = poses[static_cast<size_t>(phase % phases_)];
      for (const WalkerPose::Foot& foot : pose.feet) {
        farthest = std::max(farthest, foot.origin_m.norm());
        const Eigen::Vector3d ankle =
            foot.target.ankle_m - Eigen::Vector3d(foot.origin_m.x(), foot.origin_m.y(), 0);
        for (const double value :
             {foot.origin_m.x(), foot.origin_m.y(), ankle.x(), ankle.y(), ankle.z(),
              foot.target.pitch_rad, foot.hip_m.x(), foot.hip_m.y(), foot.hip_m.z()})
          nodes_.push_back(grained(value));
      }
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
          nodes_.push_back(grained(pose.root_from_pelvis(row, column)));
    }
  farthest_m_ = static_cast<float>(farthest);
  for (size_t side = 0; side < 2; ++side) {
    const Leg& leg = walker.leg(side);
    LegShape& shape = legs_[side];
    for (size_t axis = 0; axis < 3; ++axis) {
      shape.hip_axes[axis] = leg.hip_axis(axis).cast<float>();
      shape.columns[axis] = leg.column(axis);
    }
    shape.columns[3] = leg.column(3);
    shape.columns[4] = leg.column(4);
    shape.thigh = leg.thigh_m().cast<float>();
    shape.shank = leg.shank_m().cast<float>();
    shape.sideways = static_cast<float>(leg.sideways_m());
    const Eigen::Vector2f quarter(shape.shank.y(), -shape.shank.x());
    shape.straight_rad = angle_of(quarter.dot(shape.thigh), shape.shank.dot(shape.thigh));
    const SinCos straight = sin_cos(shape.straight_rad);
    shape.straight_cos = straight.cos;
    shape.straight_sin = straight.sin;
    shape.knee_sign = leg.knee_sign();
    shape.ankle_sign = leg.ankle_sign();
    shape.rest_heading_rad = grained(poses_by_speed.front().front().feet[side].target.heading_rad);
    shape.longest_m = grained(leg.reach_m(Walker::kStraightestKnee_rad));
    // Foot vertices turn about the place by any heading; thigh and shank lie between hip, knee and
    // ankle, no thicker than a fifth of their length.
    const auto foot_m = static_cast<float>(leg.foot_reach_m());
    const Eigen::Vector3d hip = leg.hip_m();
    const auto hip_m = static_cast<float>(std::hypot(hip.x(), hip.y()));
    reach_m_ = std::max({reach_m_, farthest_m_ + foot_m, hip_m + 1.2f * shape.thigh.norm()});
  }
  for (const JointColumn& column : model.model().kinematics.columns()) {
    lower_.push_back(column.lower);
    upper_.push_back(column.upper);
  }
}

float Footwork::root_speed(float speed_mps, float scale) const {
  const float relative = std::max(speed_mps, 0.0f) / (leg_length_m_ * scale);
  return std::min(std::sqrt(relative), static_cast<float>(speeds_ - 1) / cells_per_root_speed_);
}

void Footwork::blend(float phase, float root_speed, int floats, float* node) const {
  const float x = phase * static_cast<float>(phases_);
  const float y = root_speed * cells_per_root_speed_;
  const int column = std::clamp(static_cast<int>(x), 0, phases_ - 1);
  const int row = std::clamp(static_cast<int>(y), 0, speeds_ - 2);
  const float u = x - static_cast<float>(column), v = y - static_cast<float>(row);
  const float* a = nodes_.data() + (static_cast<ptrdiff_t>(row) * (phases_ + 1) + column) * kFloats;
  const float* c = a + static_cast<ptrdiff_t>(phases_ + 1) * kFloats;
  for (int i = 0; i < floats; ++i) {
    const float slow = a[i] + u * (a[kFloats + i] - a[i]);
    const float fast = c[i] + u * (c[kFloats + i] - c[i]);
    node[i] = slow + v * (fast - slow);
  }
}

void Footwork::natural(float phase, float root_speed, std::array<FootPlace, 2>& places) const {
  std::array<float, kFloats> node;
  blend(phase, root_speed, kFootFloats + 2, node.data());
  places[0] = {node[0], node[1], 0, 0};
  places[1] = {node[kFootFloats], node[kFootFloats + 1], 0, 0};
}

void Footwork::start(float phase, float speed_mps, float scale, Feet& feet) const {
  const float speed = root_speed(speed_mps, scale);
  natural(phase, speed, feet.places);
  for (int side = 0; side < 2; ++side) {
    const auto i = static_cast<size_t>(side);
    feet.planted[i] = own_phase(phase, side) < stance_of(speed);
    feet.offsets[i] = {};
  }
}

/// Where a foot that lands now should: so that the body passes over it as the gait has it, if it
/// goes on as it does. As an offset from the gait's own landing place.
FootPlace Footwork::landing(const RootMotion& motion, float phase_rate, float root_speed,
                            int side) const {
  const float stance = stance_of(root_speed);
  const float ahead_s = std::min(0.5f * stance / std::max(phase_rate, 1e-3f), kLongestLook_s);
  const float turn =
      std::clamp(motion.turn_rad / motion.step_s * ahead_s, -kMostTurn_rad, kMostTurn_rad);
  const float ahead = ahead_s / (motion.step_s * motion.scale);
  const SinCos half = sin_cos(0.5f * turn), whole = sin_cos(turn);
  // The chord of an arc is shorter than the arc.
  const float chord = ahead * (1 - turn * turn / 24);
  const float forward = chord * motion.forward_m, left = chord * motion.left_m;
  std::array<FootPlace, 2> lands, passes;
  natural(side == 0 ? 0.0f : 0.5f, root_speed, lands);
  const float middle = 0.5f * stance;
  natural(side == 0 ? middle : fraction(middle + 0.5f), root_speed, passes);
  const FootPlace& land = lands[static_cast<size_t>(side)];
  const FootPlace& pass = passes[static_cast<size_t>(side)];
  return {
      half.cos * forward - half.sin * left + whole.cos * pass.x_m - whole.sin * pass.y_m - land.x_m,
      half.sin * forward + half.cos * left + whole.sin * pass.x_m + whole.cos * pass.y_m - land.y_m,
      turn, 0};
}

void Footwork::keep_in_reach(FootPlace& place) const {
  place.heading_rad = std::clamp(place.heading_rad, -kMostTurn_rad, kMostTurn_rad);
  const float square = place.x_m * place.x_m + place.y_m * place.y_m;
  if (square <= farthest_m_ * farthest_m_) return;
  const float share = farthest_m_ / std::sqrt(square);
  place.x_m *= share;
  place.y_m *= share;
}

float Footwork::advance(const RootMotion& motion, float stride_m, float phase, Feet& feet) const {
  const float speed = root_speed(motion.speed_mps, motion.scale);
  const float stance = stance_of(speed);
  const SinCos turn = sin_cos(motion.turn_rad);
  std::array<FootPlace, 2> now;
  natural(phase, speed, now);

  // Planted feet stay on the ground: the root moves away under the body.
  float need = 0;
  bool in_the_air = false;
  for (size_t side = 0; side < 2; ++side) {
    FootPlace& place = feet.places[side];
    if (!feet.planted[side]) {
      in_the_air = true;
      continue;
    }
    const float x = place.x_m - motion.forward_m / motion.scale;
    const float y = place.y_m - motion.left_m / motion.scale;
    place.x_m = turn.cos * x + turn.sin * y;
    place.y_m = turn.cos * y - turn.sin * x;
    place.heading_rad -= motion.turn_rad;
    const float dx = place.x_m - now[side].x_m, dy = place.y_m - now[side].y_m;
    const float askew = std::sqrt(dx * dx + dy * dy) / (kComfortShare * leg_length_m_);
    need = std::max({need, std::abs(place.heading_rad) / kComfort_rad, askew});
  }

  const float walked_m =
      std::sqrt(motion.forward_m * motion.forward_m + motion.left_m * motion.left_m);
  float rate = walked_m / stride_m / motion.step_s;
  if (in_the_air) rate = std::max(rate, kFinishingRate_hz);
  rate = std::max(rate, kSteppingRate_hz * std::clamp(2 * need - 1, 0.0f, 1.0f));
  const float next = fraction(phase + rate * motion.step_s);
  natural(next, speed, now);

  for (int side = 0; side < 2; ++side) {
    const auto i = static_cast<size_t>(side);
    FootPlace& place = feet.places[i];
    FootPlace& offset = feet.offsets[i];
    const float before = own_phase(phase, side), after = own_phase(next, side);
    if (after < stance) {
      place.lift_m = 0;
      feet.planted[i] = true;
    } else {
      if (feet.planted[i])
        offset = {place.x_m - now[i].x_m, place.y_m - now[i].y_m, place.heading_rad, 0};
      const FootPlace goal = landing(motion, rate, speed, side);
      const float span = 1 - stance;
      const float u = feet.planted[i] ? 0 : std::max(0.0f, (before - stance) / span);
      const float v = (after - stance) / span;
      const float left_before = 1 - smooth(std::min(u, 1.0f)), left_after = 1 - smooth(v);
      const float keep = left_before > 0 ? left_after / left_before : 0;
      offset.x_m = goal.x_m + keep * (offset.x_m - goal.x_m);
      offset.y_m = goal.y_m + keep * (offset.y_m - goal.y_m);
      offset.heading_rad = goal.heading_rad + keep * (offset.heading_rad - goal.heading_rad);
      place.x_m = now[i].x_m + offset.x_m;
      place.y_m = now[i].y_m + offset.y_m;
      place.heading_rad = offset.heading_rad;
      place.lift_m = kLift_m * (1 - std::min(speed, 1.0f)) * 4 * v * (1 - v);
      feet.planted[i] = false;
    }
    keep_in_reach(place);
  }
  return next;
}

void Footwork::set(int column, float value, float* row) const {
  const auto c = static_cast<size_t>(column);
  row[c] = std::clamp(value, lower_[c], upper_[c]);
}

void Footwork::plant(const Feet& feet, float phase, float speed_mps, float scale,
                     float* row) const {
  std::array<float, kFloats> node;
  blend(phase, root_speed(speed_mps, scale), kFloats, node.data());
  std::array<Eigen::Vector3f, 2> hips, ankles;
  float drop = 0;
  for (size_t side = 0; side < 2; ++side) {
    const float* foot = node.data() + side * kFootFloats;
    const FootPlace& place = feet.places[side];
    const SinCos turn = sin_cos(place.heading_rad);
    hips[side] = {foot[6], foot[7], foot[8]};
    ankles[side] = {place.x_m + turn.cos * foot[2] - turn.sin * foot[3],
                    place.y_m + turn.sin * foot[2] + turn.cos * foot[3], foot[4] + place.lift_m};
    const Eigen::Vector3f leg = ankles[side] - hips[side];
    const float aside = leg.x() * leg.x() + leg.y() * leg.y();
    const float longest = legs_[side].longest_m;
    const float highest = std::sqrt(std::max(0.0f, longest * longest - aside));
    drop = std::max(drop, -leg.z() - highest);
  }
  const float vertical = row[vertical_column_];
  set(vertical_column_, vertical - drop, row);
  drop = vertical - row[vertical_column_];
  const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> pelvis(node.data() +
                                                                             2 * kFootFloats);
  for (int side = 0; side < 2; ++side) {
    const auto i = static_cast<size_t>(side);
    hips[i].z() -= drop;
    solve(side, hips[i], ankles[i], feet.places[i], node[i * kFootFloats + 5], pelvis, row);
  }
}

/// Leg::solve() in single precision, with sides instead of angles wherever they do.
void Footwork::solve(int side, const Eigen::Vector3f& hip, const Eigen::Vector3f& ankle,
                     const FootPlace& place, float pitch_rad, const Eigen::Matrix3f& pelvis,
                     float* row) const {
  using Eigen::Vector2f;
  using Eigen::Vector3f;
  const LegShape& shape = legs_[static_cast<size_t>(side)];
  const SinCos heading = sin_cos(shape.rest_heading_rad + place.heading_rad);
  const Vector3f forward(heading.cos, heading.sin, 0), left(-heading.sin, heading.cos, 0);
  const Vector3f leg = ankle - hip;
  const float y = leg.x() * left.x() + leg.y() * left.y(), z = leg.z();
  const float length = std::max(std::sqrt(y * y + z * z), 1e-3f);
  const float beta_cos = std::clamp(shape.sideways / length, -1.0f, 1.0f);
  const float beta_sin = std::sqrt(1 - beta_cos * beta_cos);
  const float tilt_cos = (y * beta_cos - z * beta_sin) / length;
  const float tilt_sin = (z * beta_cos + y * beta_sin) / length;
  Eigen::Matrix3f frame;
  frame.col(0) = forward;
  frame.col(1) = tilt_cos * left + tilt_sin * Vector3f::UnitZ();
  frame.col(2) = forward.cross(frame.col(1));
  const Vector2f reach(frame.col(0).dot(leg), frame.col(2).dot(leg));

  const float thigh_square = shape.thigh.squaredNorm(), shank_square = shape.shank.squaredNorm();
  const float wanted = 0.5f * (reach.squaredNorm() - thigh_square - shank_square);
  const float bend_cos = std::clamp(wanted / std::sqrt(thigh_square * shank_square), -1.0f, 1.0f);
  const float bend_sin = std::sqrt(1 - bend_cos * bend_cos);
  const float knee = shape.straight_rad + angle_of(bend_sin, bend_cos);
  const float knee_cos = shape.straight_cos * bend_cos - shape.straight_sin * bend_sin;
  const float knee_sin = shape.straight_sin * bend_cos + shape.straight_cos * bend_sin;
  const Vector2f chain(shape.thigh.x() + knee_cos * shape.shank.x() + knee_sin * shape.shank.y(),
                       shape.thigh.y() + knee_cos * shape.shank.y() - knee_sin * shape.shank.x());
  const float across = chain.y() * reach.x() - chain.x() * reach.y(), along = chain.dot(reach);
  const float size = std::max(std::sqrt(across * across + along * along), 1e-6f);
  const float turn_sin = across / size, turn_cos = along / size;
  const float ankle_turn = -pitch_rad - angle_of(across, along) - knee;

  Eigen::Matrix3f thigh = frame;  // frame * turn about y
  thigh.col(0) = turn_cos * frame.col(0) - turn_sin * frame.col(2);
  thigh.col(2) = turn_sin * frame.col(0) + turn_cos * frame.col(2);
  const Eigen::Matrix3f r = pelvis.transpose() * thigh;
  const Vector3f &a1 = shape.hip_axes[0], &a2 = shape.hip_axes[1], &a3 = shape.hip_axes[2];
  const float hand = a1.dot(a2.cross(a3)) > 0 ? 1.0f : -1.0f;
  const Vector3f end = r * a3, begin = r.transpose() * a1;
  set(shape.columns[0], angle_of(a1.cross(a3).dot(end), a3.dot(end)), row);
  set(shape.columns[1], angle_of_sine(hand * a1.dot(end)), row);
  set(shape.columns[2], -angle_of(a3.cross(a1).dot(begin), a1.dot(begin)), row);
  set(shape.columns[3], knee * shape.knee_sign, row);
  set(shape.columns[4], ankle_turn * shape.ankle_sign, row);
}

}  // namespace throng
