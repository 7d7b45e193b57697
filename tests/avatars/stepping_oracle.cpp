#include "tests/avatars/stepping_oracle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "avatars/gait/gait_curves.h"

namespace throng::test {
namespace {

using Eigen::Rotation2Dd;
using Eigen::Vector2d;
using Eigen::Vector3d;

// The gait's table: speeds uniform in the root of the relative speed, phases of the cycle.
constexpr double kMaxRelativeSpeed = 2.6;
constexpr int kSpeeds = 33;
constexpr int kPhases = 128;

constexpr double kComfort_rad = 0.3, kComfortShare = 0.12, kBeforeLift_s = 0.25;
constexpr double kMaxTurn_rad = 0.58, kMaxLandingTurnOut_rad = 0.42;

double fraction(double x) { return x - std::floor(x); }
double own_phase(double phase, size_t side) { return side == 0 ? phase : fraction(phase + 0.5); }
double smooth(double u) { return u * u * (3 - 2 * u); }
double turn_of(const OracleMotion& m) {
  return std::remainder(m.heading_after_rad - m.heading_before_rad, 2 * std::numbers::pi);
}
/// Returns the displacement in the root's previous axes, metres of the world.
Vector2d moved(const OracleMotion& m) {
  return Rotation2Dd(-m.heading_before_rad) * m.displacement_m;
}

Vector2d at_most(const Vector2d& v, double length) {
  return v.norm() > length ? Vector2d(v * (length / v.norm())) : v;
}

/// Advances by `time` along the cubic from the current speed to rest at the goal after `left`. If
/// the initial acceleration is limited by `max_acceleration`, it ends as near as possible; beyond
/// `max_speed` it moves at constant speed.
void advance_to_rest(double goal, double left, double time, double max_acceleration,
                     double max_speed, double& at, double& speed) {
  const double start =
      std::clamp((6 * (goal - at) / left - 4 * speed) / left, -max_acceleration, max_acceleration);
  const double end = at + (start * left + 4 * speed) * left / 6;
  const double c2 = (3 * (end - at) / left - 2 * speed) / left;
  const double c3 = (speed - 2 * (end - at) / left) / (left * left);
  const double gets = speed + time * (2 * c2 + time * 3 * c3);
  if (std::abs(gets) <= max_speed) {
    at += time * (speed + time * (c2 + time * c3));
    speed = gets;
    return;
  }
  const double began = std::clamp(speed, -max_speed, max_speed);
  speed = std::copysign(max_speed, gets);
  at += time * 0.5 * (began + speed);
}

/// Maximum height of supporting points above the lowest point of a flat foot.
constexpr double kSoleEdge_m = 0.005;

/// Returns the tangent of the angle between a direction and the vertical.
double lean_of(const Vector3d& up) { return up.head<2>().norm() / up.z(); }

}  // namespace

SteppingOracle::SteppingOracle(const Model& model, GaitStyle style, double upright_radius_m)
    : posable_(model),
      style_(style),
      walker_(Walker::find(posable_, style)),
      leg_m_(walker_.value().leg_length_m()),
      upright_radius_m_(upright_radius_m) {
  for (int speed = 0; speed < kSpeeds; ++speed) {
    const double root = std::sqrt(kMaxRelativeSpeed) * speed / (kSpeeds - 1);
    cycles_.push_back(walker_->cycle(std::min(root * root, kMaxRelativeSpeed), kPhases));
    if (speed == 0) cycles_.back().assign(kPhases, WalkerPose(cycles_.back().front()));
    tracks_.push_back(track_of(speed));
  }
}

SteppingOracle::Track SteppingOracle::track_of(int node) const {
  const std::vector<WalkerPose>& cycle = cycles_[static_cast<size_t>(node)];
  const double root = std::sqrt(kMaxRelativeSpeed) * node / (kSpeeds - 1);
  Track track;
  track.stance = stance_fraction(root * root, style_);
  track.stride_m = stride_per_sqrt_speed(style_) * root * leg_m_;
  track.shift_m = cycle.front().shift_m;
  for (size_t side = 0; side < 2; ++side) {
    const WalkerPose::Foot& strikes = cycle[side == 0 ? 0 : kPhases / 2].feet[side];
    track.side_m[side] =
        strikes.ground_m.y() -
        walker_->leg(side).roll_m(strikes.target.pitch_rad) * std::sin(strikes.target.heading_rad);
    if (side == 1) track.toes_out_rad = strikes.target.heading_rad;
  }
  return track;
}

double SteppingOracle::sqrt_speed(double mps, double scale) const {
  return std::min(std::sqrt(std::max(mps, 0.0) / (scale * leg_m_)), std::sqrt(kMaxRelativeSpeed));
}

int SteppingOracle::cell_of(double root) const {
  const double cells = root * (kSpeeds - 1) / std::sqrt(kMaxRelativeSpeed);
  return std::min(static_cast<int>(cells), kSpeeds - 2);
}

SteppingOracle::Track SteppingOracle::track_at(double root, int cell) const {
  const double v = root * (kSpeeds - 1) / std::sqrt(kMaxRelativeSpeed) - cell;
  const Track &a = tracks_[static_cast<size_t>(cell)], &b = tracks_[static_cast<size_t>(cell) + 1];
  return {std::lerp(a.stance, b.stance, v),
          std::lerp(a.shift_m, b.shift_m, v),
          std::lerp(a.stride_m, b.stride_m, v),
          std::lerp(a.toes_out_rad, b.toes_out_rad, v),
          {std::lerp(a.side_m[0], b.side_m[0], v), std::lerp(a.side_m[1], b.side_m[1], v)}};
}

double SteppingOracle::cycles_per_s(const OracleState& s, const OracleMotion& m,
                                    const Track& before, const Track& after) const {
  const Vector2d displacement = moved(m);
  const double turn = turn_of(m);
  const double speed = std::max(displacement.x(), 0.0) / m.step_s;
  const double stride_m = std::max(after.stride_m, 0.03 * leg_m_) * m.scale * m.stride_scale;
  double finishing = 0, behind_m = 0, turn_need = 0, way_need = 0;
  for (size_t side = 0; side < 2; ++side) {
    const OracleFoot& foot = s.feet[side];
    const double own = own_phase(s.phase, side);
    if (own >= before.stance) {  // in the air: it must land
      finishing = 0.9 * std::max(1 - speed / 0.2, 0.0);
      continue;
    }
    const double late = std::clamp(3 * (own / before.stance - 0.2), 0.0, 1.0);
    behind_m = std::max(behind_m, -late * foot.shift_m.x());
    if (foot.turn_rad * turn <= 0)
      turn_need = std::max(
          turn_need, std::abs(foot.turn_rad - kBeforeLift_s / m.step_s * turn) / kComfort_rad);
    if (foot.shift_m.dot(displacement) <= 0)
      way_need = std::max(way_need, foot.shift_m.norm() / (kComfortShare * leg_m_));
  }
  double rate = speed / stride_m;
  if (speed > 0) rate += std::min(behind_m * m.scale / stride_m / 0.12, 0.35);
  rate = std::max(rate, finishing);
  const double turning = std::min(before.stance * std::abs(turn) / m.step_s / 0.87, 1.6);
  rate = std::max(rate, turning * std::min(speed / 0.2, 1.0));
  const double aside_m = std::abs(displacement.y()) + std::max(-displacement.x(), 0.0);
  const double travel =
      std::max(std::abs(turn) / kComfort_rad, aside_m / m.scale / (kComfortShare * leg_m_));
  const double stepping = std::clamp(0.5 * before.stance * travel / m.step_s, 1.2, 1.6);
  const double due = 2 * std::max(turn_need, way_need) - 1;
  const double urgency = std::clamp(std::max(due, std::min(15 * due, 0.3)), 0.0, 1.0);
  return std::max(rate, std::max(1 - speed / 0.8, 0.0) * stepping * urgency);
}

SteppingOracle::Landing SteppingOracle::landing(const OracleMotion& m, double rate,
                                                const Track& track, size_t side) const {
  const double ahead_s = std::min(0.5 * track.stance / std::max(rate, 1e-3), 0.9);
  const double steps = ahead_s / m.step_s;
  const double turn = std::clamp(turn_of(m) * steps, -kMaxTurn_rad, kMaxTurn_rad);
  const double chord = std::abs(turn) > 1e-9 ? std::sin(0.5 * turn) / (0.5 * turn) : 1;
  Vector2d displacement = steps * chord / m.scale * moved(m);
  // The trailing foot keeps a distance from the leading one.
  displacement.y() =
      side == 0 ? std::min(displacement.y(), 0.03) : std::max(displacement.y(), -0.03);
  const Vector2d passes(track.x_at(0.5 * track.stance), track.side_m[side]);
  const Vector2d lands(track.x_at(0), track.side_m[side]);
  constexpr double kUsed_rad = 0.95 * kMaxTurn_rad;
  const double inwards = kUsed_rad, outwards = kMaxLandingTurnOut_rad;
  const double left = side == 0 ? inwards : outwards, right = side == 0 ? outwards : inwards;
  const double foot =
      turn > 0 ? std::max(turn, 2 * turn - kUsed_rad) : std::min(turn, 2 * turn + kUsed_rad);
  return {Rotation2Dd(0.5 * turn) * displacement + Rotation2Dd(turn) * passes - lands,
          std::clamp(foot, -right, left)};
}

/// The foot stays on its place on the ground, within the limits of leg and bounds.
OracleFoot SteppingOracle::stance_foot(const OracleState& s, const OracleMotion& m,
                                       const Track& before, const Track& after, double own_next,
                                       size_t side) const {
  OracleFoot foot = s.feet[side];
  foot.lift_m = 0;
  foot.speed.setZero();
  const double own = own_phase(s.phase, side);
  const Vector2d natural(after.x_at(own_next), after.side_m[side]);
  if (own < before.stance) {
    const Vector2d stood = Vector2d(before.x_at(own), before.side_m[side]) + foot.shift_m;
    foot.shift_m = Rotation2Dd(-turn_of(m)) * (stood - moved(m) / m.scale) - natural;
    foot.turn_rad -= turn_of(m);
  }
  const double allowed = std::clamp(foot.turn_rad, -kMaxTurn_rad, kMaxTurn_rad);
  const double forced = allowed - foot.turn_rad, contact_m = 0.25 * own_next;
  foot.shift_m += contact_m * forced * Vector2d(allowed, -1);
  foot.turn_rad = allowed;
  foot.shift_m = at_most(foot.shift_m, 0.4 * leg_m_);
  foot.shift_m = at_most(natural + foot.shift_m, 1.2 * upright_radius_m_) - natural;
  return foot;
}

/// The offset vanishes at landing, within the limits; the foot can always come to rest by then.
OracleFoot SteppingOracle::swing_foot(const OracleFoot& foot, const Landing& goal, double own,
                                      double own_next, double rate, double step_s,
                                      const Track& track) const {
  const auto share = [&](double phase) {
    return std::clamp((phase - track.stance) / (1 - track.stance), 0.0, 1.0);
  };
  const double u = share(own), v = share(own_next);
  const double swings_ps = std::max(rate / (1 - track.stance), 1e-3);
  const double until_s = (1 - v) / swings_ps + step_s;
  OracleFoot next = foot;
  const auto go = [&](double to, double max_speed_ps, double max_acceleration_ps2, double& at,
                      double& speed) {
    advance_to_rest(to, 1 - u, v - u, max_acceleration_ps2 / (swings_ps * swings_ps),
                    std::min(max_speed_ps, max_acceleration_ps2 * until_s) / swings_ps, at, speed);
  };
  go(goal.shift_m.x(), 100, 40, next.shift_m.x(), next.speed.x());
  go(goal.turn_rad, 3.6, 60, next.turn_rad, next.speed.z());
  go(goal.shift_m.y(), 2.6 - 0.28 * std::abs(next.speed.z()) * swings_ps, 40, next.shift_m.y(),
     next.speed.y());
  const double step_m =
      ((foot.shift_m - goal.shift_m).norm() + 0.2 * std::abs(foot.turn_rad - goal.turn_rad)) /
      std::max(1 - smooth(u), 0.01);
  next.lift_m = std::min({0.4 * step_m, 0.04, 0.16 / swings_ps}) * std::pow(4 * v * (1 - v), 2) *
                std::max(1 - track.stride_m / leg_m_, 0.0);
  return next;
}

OracleState SteppingOracle::step(const OracleState& s, const OracleMotion& m) const {
  if (!m.is_present) return s;
  OracleState next = s;
  if (s.gait_mps < 0 || m.displacement_m.norm() > 1) {
    next.gait_mps = std::max(m.ahead_mps, 0.0);
    next.feet = {};
    next.cadence_hz = -1;
    return next;
  }
  const double change = std::max(m.ahead_mps, 0.0) - s.gait_mps;
  next.gait_mps += std::copysign(std::max(m.step_s / (0.25 + m.step_s) * std::abs(change),
                                          std::min(std::abs(change), 0.2 * m.step_s)),
                                 change);
  const double root = sqrt_speed(next.gait_mps, m.scale);
  const int cell = cell_of(root);
  const Track after = track_at(root, cell);
  const Track before = track_at(sqrt_speed(s.gait_mps, m.scale), cell);
  const double target = std::min(cycles_per_s(s, m, before, after), 1.9),
               max_change = 14 * m.step_s;
  const double rate =
      s.cadence_hz < 0 ? target
                       : std::clamp(target, s.cadence_hz - max_change, s.cadence_hz + max_change);
  next.cadence_hz = rate;
  next.phase = fraction(s.phase + rate * m.step_s);
  for (size_t side = 0; side < 2; ++side) {
    const double own = own_phase(s.phase, side), own_next = own_phase(next.phase, side);
    if (own_next < after.stance) {
      next.feet[side] = stance_foot(s, m, before, after, own_next, side);
      continue;
    }
    Landing goal = landing(m, rate, after, side);
    goal.shift_m = at_most(at_most(goal.shift_m, 0.3 * leg_m_) + m.landing_m[side], 0.38 * leg_m_);
    next.feet[side] = swing_foot(s.feet[side], goal, own, own_next, rate, m.step_s, after);
  }
  return next;
}

bool SteppingOracle::is_at_a_turning_point(const OracleState& before, const OracleState& after,
                                           const OracleMotion& m) const {
  constexpr double kTolerance = 1e-4;
  const auto is_near_zero = [](double x, double size) {
    return x != 0 && std::abs(x) < kTolerance * size;
  };
  const Vector2d displacement = moved(m);
  if (is_near_zero(displacement.x(), displacement.norm())) return true;
  const int cell = cell_of(sqrt_speed(after.gait_mps, m.scale));
  for (size_t side = 0; side < 2; ++side) {
    const OracleFoot& foot = before.feet[side];
    if (is_near_zero(foot.shift_m.dot(displacement), foot.shift_m.norm() * displacement.norm()) ||
        is_near_zero(foot.turn_rad, 1))
      return true;
    for (const OracleState* s : {&before, &after}) {
      const double own = own_phase(s->phase, side);
      const double stance = track_at(sqrt_speed(s->gait_mps, m.scale), cell).stance;
      for (const double turning : {0.0, 0.5 * stance, stance, 1.0})
        if (std::abs(own - turning) < kTolerance) return true;
    }
  }
  return false;
}

SteppingOracle::Ankle SteppingOracle::ankle(const OracleState& s, double scale, size_t side,
                                            double drop_m, double raise_rad) const {
  const double root = sqrt_speed(s.gait_mps, scale);
  const int cell = cell_of(root);
  const Track track = track_at(root, cell);
  const double v = root * (kSpeeds - 1) / std::sqrt(kMaxRelativeSpeed) - cell;
  const double x = s.phase * kPhases;
  const int phase = std::min(static_cast<int>(x), kPhases - 1);
  const double u = x - phase;
  const Leg& leg = walker_->leg(side);
  Vector3d hip = Vector3d::Zero();
  double ground_x = 0, ground_z = 0, roll = 0;
  double natural_lean = 0;
  FootTarget target;
  for (const int speed_stride : {0, 1})
    for (const int phase_stride : {0, 1}) {
      const double share = (speed_stride == 1 ? v : 1 - v) * (phase_stride == 1 ? u : 1 - u);
      const WalkerPose::Foot& foot =
          cycles_[static_cast<size_t>(cell) + static_cast<size_t>(speed_stride)]
                 [(static_cast<size_t>(phase) + static_cast<size_t>(phase_stride)) % kPhases]
                     .feet[side];
      const double rolled = leg.roll_m(foot.target.pitch_rad);
      hip += share * foot.hip_m;
      ground_x += share * (foot.ground_m.x() - rolled * std::cos(foot.target.heading_rad));
      ground_z += share * foot.ground_m.z();
      roll += share * rolled;
      target.pitch_rad += share * foot.target.pitch_rad;
      natural_lean = std::max(natural_lean, lean_of(leg.up_along_leg(foot.hip_m, foot.target)));
    }
  // Rolls on over its toes.
  roll += leg.roll_m(target.pitch_rad - raise_rad) - leg.roll_m(target.pitch_rad);
  target.pitch_rad -= raise_rad;
  const OracleFoot& foot = s.feet[side];
  target.heading_rad = (side == 0 ? -1 : 1) * track.toes_out_rad + foot.turn_rad;
  hip.z() -= drop_m;
  const Vector3d ground(ground_x + foot.shift_m.x() + roll * std::cos(target.heading_rad),
                        track.side_m[side] + foot.shift_m.y() + roll * std::sin(target.heading_rad),
                        ground_z + foot.lift_m);
  target.ankle_m = ground;  // the direction of the leg
  const Vector3d over = leg.ankle_over_ground_m(hip, target);
  const Vector3d at = ground + over;
  const bool is_flat = std::abs(target.pitch_rad) < 0.01;
  const double width_m = 2 * leg.shape().sole_half_width_m;
  return {
      .at_m = at,
      .up = over.normalized(),
      .too_high_m = is_flat ? kSoleEdge_m : width_m * lean_of(over),
      .too_low_m = is_flat ? 0 : width_m * natural_lean,
      .heading_rad = target.heading_rad,
      .pitch_rad = target.pitch_rad,
      .from_hip_m = (at - hip).norm(),
      .is_behind =
          Rotation2Dd(-target.heading_rad).toRotationMatrix().row(0).dot((at - hip).head<2>()) < 0};
}

}  // namespace throng::test
