#include "avatars/yielding/yielding.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {
// Room once made is kept for a while: others sway. What is given up a second, with somebody near
// and without.
constexpr float kReleaseNear_rps = 0.3f, kRelease_rps = 1.2f;
constexpr float kReleaseAhead_s = 1.0f / 9;  // as eased_towards() has it
// What is nearer to nothing (radians, shares of an arm) is over.
constexpr float kHardly = 1e-3f;

void eased_towards(float wanted, float most_speed, float most_acceleration, float step_s,
                   float& value, float& speed) {
  // As fast as one can be and still stop there; near it slower, so that it is reached smoothly.
  constexpr float kPerSecond = 9;
  const float left = wanted - value, size = std::abs(left);
  const float fastest =
      std::min({most_speed, std::sqrt(1.4f * most_acceleration * size), kPerSecond * size});
  const float change = std::copysign(fastest, left) - speed;
  const float most_change = most_acceleration * step_s;
  speed += std::clamp(change, -most_change, most_change);
  value += speed * step_s;
  if (wanted == 0 && std::abs(value) < kHardly && std::abs(speed) < kPerSecond * kHardly)
    value = speed = 0;
}

/// What is wanted, but no more than `most` nearer to nothing than now.
float held(float wanted, float now, float most) {
  if (std::abs(now) <= most) return wanted;
  return now > 0 ? std::max(wanted, now - most) : std::min(wanted, now + most);
}

}  // namespace

DrawnArm::DrawnArm(float share) {
  tucked = std::min(share / kTucked, 1.0f);
  const float u = std::max(share - kTucked, 0.0f) / (1 - kTucked);
  stilled = u * u * (2 - u);  // begins at rest
}

void follow(const YieldMotion& wanted, float step_s, YieldMotion& motion) {
  const YieldLimits& limits = kYieldLimits;
  const float turn_release = (wanted.is_near ? kReleaseNear_rps : kRelease_rps) * kReleaseAhead_s;
  const bool turns_back = wanted.turn_rad * motion.turn_rad < 0;
  const float turn_rad = turns_back || wanted.is_pressed
                             ? wanted.turn_rad
                             : held(wanted.turn_rad, motion.turn_rad, turn_release);
  eased_towards(turn_rad, limits.trunk_rps, limits.trunk_rps2, step_s, motion.turn_rad,
                motion.turn_rps);
  for (size_t side = 0; side < 2; ++side) {
    float& arm = motion.arms[side];
    eased_towards(wanted.arms[side], limits.arm_ps, limits.arm_ps2, step_s, arm,
                  motion.arms_ps[side]);
    if (arm >= 0 && arm <= 1) continue;
    arm = std::clamp(arm, 0.0f, 1.0f);
    motion.arms_ps[side] = 0;
  }
}

void follow_standing(bool stands, float step_s, YieldMotion& motion) {
  const YieldLimits& limits = kYieldLimits;
  eased_towards(stands ? 1.0f : 0.0f, stands ? limits.standing_ps : limits.leaving_ps,
                limits.standing_ps2, step_s, motion.standing, motion.standing_ps);
  if (motion.standing >= 0 && motion.standing <= 1) return;
  motion.standing = std::clamp(motion.standing, 0.0f, 1.0f);
  motion.standing_ps = 0;
}

void put_yield(const YieldColumns& columns, const Yield& yield, const StandingPosture& posture,
               std::span<float> row) {
  if (yield.is_none()) return;
  if (yield.standing > 0) put_standing_arms(columns, posture, yield.standing, row);
  const float turn_rad = yield.trunk_rad + yield.standing * posture.trunk_rad;
  float& trunk = row[static_cast<size_t>(columns.trunk)];
  const float before = trunk;
  // The nearer to the joint's limit, the less of the gait's own turning: nothing is cut off.
  const float most_rad = turn_rad > 0 ? columns.most_trunk_rad : -columns.least_trunk_rad;
  const float turned = std::min(std::abs(turn_rad) / most_rad, 1.0f);
  trunk = std::clamp(turn_rad + (1 - turned * turned) * before, columns.least_trunk_rad,
                     columns.most_trunk_rad);
  if (columns.head >= 0) {
    float& head = row[static_cast<size_t>(columns.head)];
    head = std::clamp(head - (trunk - before), columns.least_head_rad, columns.most_head_rad);
  }
  for (size_t side = 0; side < 2; ++side) {
    const DrawnArm drawn(yield.arms[side]);
    for (size_t i = 0; i < YieldColumns::kArmJoints; ++i) {
      float& angle = row[static_cast<size_t>(columns.arms[side][i])];
      const float share = i == YieldColumns::kAbduction ? drawn.tucked : drawn.stilled;
      angle += share * (columns.drawn_rad[side][i] - angle);
    }
  }
}

}  // namespace throng
