#include "crowd/turning.h"

#include <algorithm>
#include <cmath>

#include "avatars/gait/gait.h"
#include "base/portable_math.h"

namespace throng {
namespace {

/// Turn rate for a remaining angle: no faster than can be stopped at its end.
double turn_rate_radps(double off_rad, double max_radps, double max_radps2, double step_s) {
  const double size = std::abs(off_rad);
  return std::copysign(std::min({max_radps, std::sqrt(2 * max_radps2 * size), size / step_s}),
                       off_rad);
}

}  // namespace

Turning::Turning(SteeringState& state, const Journeys& journeys, const SocialGroups& groups,
                 const Queues& queues, std::span<const AgentSpec> people)
    : state_(state), journeys_(journeys), social_groups_(groups), queues_(queues) {
  for (const AgentSpec& person : people) look_at_m_.push_back(person.look_at_m);
}

void Turning::decide(size_t slot) {
  find_facing(slot);
  state_.agents[slot].target_head_yaw_rad = target_head_yaw_rad(slot);
}

double Turning::step(size_t slot) {
  const double turned_rad = turn(slot);
  turn_head(slot);
  return turned_rad;
}

/// Facing of waiting agents; others face the direction of their preferred velocity.
void Turning::find_facing(size_t slot) {
  const uint32_t id = state_.id(slot);
  if (journeys_.state(id) == JourneyState::kWalking && !social_groups_.stands(id)) return;
  const Eigen::Vector2d& position = state_.agents[slot].position_m;
  const bool looks_ahead = queues_.any() && !queues_.facing(id).isZero() &&
                           (!look_at_m_[id] || journeys_.state(id) == JourneyState::kQueuing);
  const Eigen::Vector2d facing = looks_ahead ? queues_.facing(id)
                                 : social_groups_.stands(id)
                                     ? social_groups_.waits_for_m(id) - position
                                 : look_at_m_[id] ? *look_at_m_[id] - position
                                                  : journeys_.facing(id, position);
  const double length = facing.norm();
  state_.agents[slot].facing =
      length > 0 ? Eigen::Vector2d(facing / length) : Eigen::Vector2d::Zero();
}

/// Uses the sine of the angle to the preferred direction for the angle, up to the limit of heads.
float Turning::target_head_yaw_rad(size_t slot) const {
  const Eigen::Vector2f heading = state_.agents[slot].heading.cast<float>();
  float x = state_.agents.published[slot].direction_x,
        y = state_.agents.published[slot].direction_y;
  if (x == 0 && y == 0) {  // stands
    x = static_cast<float>(state_.agents[slot].facing.x());
    y = static_cast<float>(state_.agents[slot].facing.y());
  }
  const float left = heading.x() * y - heading.y() * x, ahead = heading.x() * x + heading.y() * y;
  if (ahead < 0) return std::copysign(Gait::kMaxHeadYaw_rad, left);
  return std::clamp(left, -Gait::kMaxHeadYaw_rad, Gait::kMaxHeadYaw_rad);
}

void Turning::turn_head(size_t slot) {
  const auto step_s = static_cast<float>(state_.step_s);
  float& head_yaw_rad = state_.head_yaws_rad[state_.id(slot)];
  float& head_yaw_radps = state_.agents[slot].head_yaw_radps;
  const float target_radps =
      (state_.agents[slot].target_head_yaw_rad - head_yaw_rad) / (tuning::kHeadYawTime_s + step_s);
  const float max_radps = tuning::kHeadYaw_radps2 * step_s;
  head_yaw_radps += std::clamp(target_radps - head_yaw_radps, -max_radps, max_radps);
  head_yaw_rad = std::clamp(head_yaw_rad + step_s * head_yaw_radps, -Gait::kMaxHeadYaw_rad,
                            Gait::kMaxHeadYaw_rad);
}

double Turning::turn(size_t slot) {
  Eigen::Vector2d& smooth = state_.agents[slot].smooth_mps;
  smooth += state_.step_s / (tuning::kTurnSmoothing_s + state_.step_s) *
            (state_.agents[slot].velocity_mps - smooth);
  const double speed = smooth.norm(), now_square = state_.agents[slot].velocity_mps.squaredNorm();
  if (speed >= tuning::kWalkingSpeed_mps &&
      now_square >= tuning::kWalkingSpeed_mps * tuning::kWalkingSpeed_mps)
    return turn_to_direction(slot, smooth / speed);
  const double slower = std::min(speed, std::sqrt(now_square));
  const double walks = (slower - tuning::kStandingSpeed_mps) /
                       (tuning::kWalkingSpeed_mps - tuning::kStandingSpeed_mps);
  const Eigen::Vector2d& facing = state_.agents[slot].facing;
  Eigen::Vector2d to = facing;
  if (walks > 0) to = facing.isZero() ? smooth : (1 - walks) * facing + (walks / speed) * smooth;
  return turn_on_spot(slot, std::max(walks, 0.0), to);
}

/// Turns a walking agent to its direction.
double Turning::turn_to_direction(size_t slot, const Eigen::Vector2d& to) {
  const Eigen::Vector2d& from = state_.agents[slot].heading;
  double& rate = state_.agents[slot].turn_radps;
  const double left = from.x() * to.y() - from.y() * to.x(), ahead = from.dot(to);
  constexpr double kHardly = 0.99;  // cosine: beyond it the sine is close to the angle
  const double off = ahead > kHardly ? left : arc_tan2(left, ahead);
  const double target =
      turn_rate_radps(off, tuning::kMaxTurn_radps, tuning::kTurnWalking_radps2, state_.step_s);
  const double at_once = off / state_.step_s;
  if (target != at_once || std::abs(target - rate) > tuning::kTurnWalking_radps2 * state_.step_s)
    return apply_turn(slot, target, tuning::kTurnWalking_radps2);
  rate = target;
  state_.headings[state_.id(slot)] = state_.agents[slot].heading = to;
  return std::abs(off);
}

/// Turns a standing agent once the angle is large enough, and then completely. `walks` from 0 to 1
/// blends to the turning of walking agents.
double Turning::turn_on_spot(size_t slot, double walks, const Eigen::Vector2d& to) {
  const double rate = state_.agents[slot].turn_radps;
  const Eigen::Vector2d& from = state_.agents[slot].heading;
  const double max_radps =
      tuning::kTurnOnSpot_radps + walks * (tuning::kMaxTurn_radps - tuning::kTurnOnSpot_radps);
  const double max_radps2 =
      tuning::kTurnStart_radps2 + walks * (tuning::kTurnWalking_radps2 - tuning::kTurnStart_radps2);
  double target = 0;
  if (!to.isZero()) {
    const double off = arc_tan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
    const double far = rate == 0 ? (1 - walks) * tuning::kTurnFrom_rad : tuning::kTurnTo_rad;
    if (std::abs(off) > far) target = turn_rate_radps(off, max_radps, max_radps2, state_.step_s);
  }
  return apply_turn(slot, target,
                    std::abs(rate) > max_radps ? tuning::kTurnStop_radps2 : max_radps2);
}

/// Turns on, at a rate as close to the target as its acceleration allows.
double Turning::apply_turn(size_t slot, double target_radps, double max_radps2) {
  double& rate = state_.agents[slot].turn_radps;
  const double change = max_radps2 * state_.step_s;
  rate += std::clamp(target_radps - rate, -change, change);
  if (rate == 0) return 0;
  const Eigen::Vector2d from = state_.agents[slot].heading;
  const SinCos turned = sin_cos(rate * state_.step_s);
  state_.headings[state_.id(slot)] = state_.agents[slot].heading =
      Eigen::Vector2d(turned.cos * from.x() - turned.sin * from.y(),
                      turned.sin * from.x() + turned.cos * from.y())
          .normalized();
  return std::abs(rate) * state_.step_s;
}

}  // namespace throng
