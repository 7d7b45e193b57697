// What people want: the way of their journey at their free speed, taken up smoothly.
#include <cmath>

#include "base/random.h"
#include "scenes/crowd.h"
#include "scenes/crowd_tuning.h"

namespace throng {

Eigen::Vector2d Crowd::wanted_mps(size_t slot) {
  const uint32_t id = grid_.order()[slot];
  Eigen::Vector2d direction = journeys_.direction(id, walkers_.position_m[slot]);
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

}  // namespace throng
