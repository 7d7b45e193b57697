// What people want: the way of their journey at their free speed, taken up smoothly.
#include <algorithm>
#include <cmath>

#include "avatars/gait/gait.h"
#include "base/random.h"
#include "scenes/crowd/crowd.h"
#include "scenes/crowd/crowd_tuning.h"

namespace throng {

Eigen::Vector2d Crowd::wanted_mps(size_t slot) {
  const uint32_t id = grid_.order()[slot];
  Eigen::Vector2d direction = journeys_.direction(id, walkers_.position_m[slot]);
  walkers_.facing[slot] = direction;
  const double stalled_s = stalled_s_of(slot);
  if (stalled_s > tuning::kStuck_s) {
    const auto second = static_cast<uint64_t>(std::floor(stalled_s));
    const RandomKey key{options_.seed, id,
                        static_cast<uint64_t>(walkers_.anchor_step[slot]) + second,
                        Purpose::kSymmetryBreaking};
    const double side = random_uniform(key, -tuning::kSidestep, tuning::kSidestep, 2);
    direction += side * Eigen::Vector2d(-direction.y(), direction.x());
    if (direction.squaredNorm() > 0) direction.normalize();
  }
  const double share = period_s_ / (tuning::kRelaxation_s + period_s_);
  Eigen::Vector2d& intent = walkers_.intent_mps[slot];
  intent += share * (walkers_.free_speed_mps[slot] * direction - intent);
  const RandomKey key{options_.seed, id, static_cast<uint64_t>(steps_), Purpose::kSymmetryBreaking};
  // One draw for both axes: half of its bits are plenty.
  const uint64_t bits = random_bits(key);
  const auto shake = [](uint64_t half) {
    return tuning::kPerturbation_mps * (static_cast<double>(half) * 0x1.0p-31 - 1);
  };
  return intent + Eigen::Vector2d(shake(bits & 0xffffffff), shake(bits >> 32));
}

/// What somebody looks at who waits for the time to come; others look to the way that
/// wanted_mps() has found.
void Crowd::find_facing(size_t slot) {
  const uint32_t id = grid_.order()[slot];
  if (journeys_.doing(id) == Doing::kWalking) return;
  const Eigen::Vector2d& position = walkers_.position_m[slot];
  const Eigen::Vector2d facing =
      faces_m_[id] ? *faces_m_[id] - position : journeys_.facing(id, position);
  const double length = facing.norm();
  walkers_.facing[slot] = length > 0 ? Eigen::Vector2d(facing / length) : Eigen::Vector2d::Zero();
}

/// The sine of the angle from the heading to the way wanted does for it, as far as heads turn.
float Crowd::look_to_rad(size_t slot) const {
  const Eigen::Vector2f heading = walkers_.heading[slot].cast<float>();
  float x = slots_.way_x[slot], y = slots_.way_y[slot];
  if (x == 0 && y == 0) {  // stands
    x = static_cast<float>(walkers_.facing[slot].x());
    y = static_cast<float>(walkers_.facing[slot].y());
  }
  const float left = heading.x() * y - heading.y() * x, ahead = heading.x() * x + heading.y() * y;
  if (ahead < 0) return std::copysign(Gait::kMostLook_rad, left);
  return std::clamp(left, -Gait::kMostLook_rad, Gait::kMostLook_rad);
}

}  // namespace throng
