#include "avatars/body_avoidance/body_avoidance.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {
// Release rates. With constraints a turn is released slowly, because neighbours sway.
constexpr float kConstrainedRelease_rps = 0.3f, kFreeRelease_rps = 1.2f;
constexpr float kReleaseTime_s = 1.0f / 9;  // as in ease_towards()
// Values below this (radians, shares of an arm) count as zero.
constexpr float kNegligible = 1e-3f;

void ease_towards(float target, float max_speed, float max_acceleration, float step_s, float& value,
                  float& speed) {
  // The highest speed from which the value can still stop at the target; lower near it.
  constexpr float kPerSecond = 9;
  const float left = target - value, size = std::abs(left);
  const float max_speed_now =
      std::min({max_speed, std::sqrt(1.4f * max_acceleration * size), kPerSecond * size});
  const float change = std::copysign(max_speed_now, left) - speed;
  const float max_change = max_acceleration * step_s;
  speed += std::clamp(change, -max_change, max_change);
  value += speed * step_s;
  if (target == 0 && std::abs(value) < kNegligible && std::abs(speed) < kPerSecond * kNegligible)
    value = speed = 0;
}

/// Returns the target, at most `band` nearer to zero than `now`.
float with_hysteresis(float target, float now, float band) {
  if (std::abs(now) <= band) return target;
  return now > 0 ? std::max(target, now - band) : std::min(target, now + band);
}

}  // namespace

ArmTuck::ArmTuck(float share) {
  tuck = std::min(share / kTuckShare, 1.0f);
  const float u = std::max(share - kTuckShare, 0.0f) / (1 - kTuckShare);
  swing_damping = u * u * (2 - u);  // starts with zero slope
}

void follow(const AvoidanceMotion& target, float step_s, AvoidanceMotion& motion) {
  const AvoidanceLimits& limits = kAvoidanceLimits;
  const float turn_release =
      (target.has_constraints ? kConstrainedRelease_rps : kFreeRelease_rps) * kReleaseTime_s;
  const bool turns_back = target.turn_rad * motion.turn_rad < 0;
  const float turn_rad = turns_back || target.is_urgent
                             ? target.turn_rad
                             : with_hysteresis(target.turn_rad, motion.turn_rad, turn_release);
  ease_towards(turn_rad, limits.trunk_rps, limits.trunk_rps2, step_s, motion.turn_rad,
               motion.turn_rps);
  for (size_t side = 0; side < 2; ++side) {
    float& arm = motion.arms[side];
    ease_towards(target.arms[side], limits.arm_ps, limits.arm_ps2, step_s, arm,
                 motion.arms_ps[side]);
    if (arm >= 0 && arm <= 1) continue;
    arm = std::clamp(arm, 0.0f, 1.0f);
    motion.arms_ps[side] = 0;
  }
}

void follow_standing(bool stands, float step_s, AvoidanceMotion& motion) {
  const AvoidanceLimits& limits = kAvoidanceLimits;
  ease_towards(stands ? 1.0f : 0.0f, stands ? limits.standing_ps : limits.leaving_ps,
               limits.standing_ps2, step_s, motion.standing, motion.standing_ps);
  if (motion.standing >= 0 && motion.standing <= 1) return;
  motion.standing = std::clamp(motion.standing, 0.0f, 1.0f);
  motion.standing_ps = 0;
}

void apply_avoidance(const AvoidanceColumns& columns, const AvoidancePosture& avoidance,
                     const StandingPosture& posture, std::span<float> row) {
  if (avoidance.is_none()) return;
  if (avoidance.standing > 0) apply_standing_arms(columns, posture, avoidance.standing, row);
  const float turn_rad = avoidance.trunk_rad + avoidance.standing * posture.trunk_rad;
  float& trunk = row[static_cast<size_t>(columns.trunk)];
  const float before = trunk;
  // Near the joint's limit less of the gait's own rotation is added, which avoids clipping.
  const float max_rad = turn_rad > 0 ? columns.max_trunk_rad : -columns.min_trunk_rad;
  const float turned = std::min(std::abs(turn_rad) / max_rad, 1.0f);
  trunk = std::clamp(turn_rad + (1 - turned * turned) * before, columns.min_trunk_rad,
                     columns.max_trunk_rad);
  if (columns.head >= 0) {
    float& head = row[static_cast<size_t>(columns.head)];
    head = std::clamp(head - (trunk - before), columns.min_head_rad, columns.max_head_rad);
  }
  for (size_t side = 0; side < 2; ++side) {
    const ArmTuck arm_tuck(avoidance.arms[side]);
    for (size_t i = 0; i < AvoidanceColumns::kArmJoints; ++i) {
      float& angle = row[static_cast<size_t>(columns.arms[side][i])];
      const float share =
          i == AvoidanceColumns::kAbduction ? arm_tuck.tuck : arm_tuck.swing_damping;
      angle += share * (columns.tucked_rad[side][i] - angle);
    }
  }
}

}  // namespace throng
