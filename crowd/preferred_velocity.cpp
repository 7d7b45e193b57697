#include "crowd/preferred_velocity.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "crowd/crowd_tuning.h"

namespace throng {

void PreferredVelocity::prepare(SteeringState::Slots slots) {
  // The fields exceed the caches: prefetched here, they arrive during the neighbour search.
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    const uint32_t later = state_.later_decider(slots, i);
    state_.agents.prefetch(later, sizeof(AgentState));
    journeys_.prefetch(state_.id(later));
    state_.agents[slot].lateral_offset_m = lateral_offset_m(slot);
    journeys_.prefetch(state_.id(slot), state_.agents[slot].position_m, lateral_offset(slot));
  }
}

void PreferredVelocity::decide(size_t slot) {
  state_.set_preferred(slot, preferred_mps(slot).cast<float>());
}

void PreferredVelocity::publish_waiting(SteeringState::Slots slots) {
  for (const uint32_t slot : slots)
    state_.agents[slot].waits_at_door = state_.decisions.next_waits_at_door[slot];
}

Eigen::Vector2d PreferredVelocity::preferred_mps(size_t slot) {
  const uint32_t id = state_.id(slot);
  const bool is_in_group =
      social_groups_.has(id) &&
      journeys_.state(id) != JourneyState::kQueuing;  // each has its own position
  Eigen::Vector2d direction =
      is_in_group ? social_groups_.solo_direction(id)
                  : journeys_.direction(id, state_.agents[slot].position_m, lateral_offset(slot),
                                        state_.agents[slot].clearance_m);
  state_.agents[slot].facing = direction;
  const double door_factor = door_controller_.has_doors() ? door_speed_factor(slot, direction) : 1;
  if (is_in_group) direction = social_groups_.group_direction(id);
  if (door_factor != 1) direction *= door_factor;
  const double stalled_s = state_.stalled_s(slot);
  if (state_.traits.uses_random_sidesteps && stalled_s > tuning::kStuck_s) {
    const auto second = static_cast<uint64_t>(std::floor(stalled_s));
    const RandomKey key{seed_, id, static_cast<uint64_t>(state_.agents[slot].anchor_step) + second,
                        Purpose::kSymmetryBreaking};
    const double side = random_uniform(key, -tuning::kMaxSidestep, tuning::kMaxSidestep, 2);
    direction += side * Eigen::Vector2d(-direction.y(), direction.x());
    if (direction.squaredNorm() > 0) direction.normalize();
  }
  if (is_in_group) direction *= social_groups_.speed_factor(id);
  const double share = state_.traits.smooths_velocity
                           ? 1
                           : state_.period_s / (tuning::kRelaxation_s + state_.period_s);
  Eigen::Vector2d& smoothed = state_.agents[slot].smoothed_preferred_mps;
  smoothed += share * (state_.agents[slot].desired_speed_mps * direction - smoothed);
  const RandomKey key{seed_, id, static_cast<uint64_t>(state_.steps), Purpose::kSymmetryBreaking};
  // One draw for both axes: half of its bits suffice.
  const uint64_t bits = random_bits(key);
  const auto shake = [](uint64_t half) {
    return tuning::kPerturbation_mps * (static_cast<double>(half) * 0x1.0p-31 - 1);
  };
  return smoothed + Eigen::Vector2d(shake(bits & 0xffffffff), shake(bits >> 32));
}

/// Lateral offset of an agent, positive to the left: its own constant, limited by walls and by the
/// agent's speed, and approached gradually.
double PreferredVelocity::lateral_offset_m(size_t slot) const {
  if (!state_.traits.uses_lateral_offset) return 0;
  const double free_path_m =
      std::max(state_.agents[slot].clearance_m - tuning::kLateralOffsetFrom_m, 0.0);
  const double relative_speed =
      state_.agents[slot].velocity_mps.norm() / state_.agents[slot].desired_speed_mps;
  const double share =
      tuning::ramp(tuning::kLateralOffsetSlow, tuning::kLateralOffsetFast, relative_speed);
  const RandomKey key{seed_, state_.id(slot), 0, Purpose::kLateralOffset};
  const double target_m = share * random_uniform(key, -free_path_m, free_path_m);
  const double max_m = tuning::kLateralOffsetRate_mps * state_.period_s,
               now_m = state_.agents[slot].lateral_offset_m;
  return std::clamp(target_m, now_m - max_m, now_m + max_m);
}

/// Speed factor of an agent whose path leads through a closed door. It walks up to the door, or to
/// agents that wait there, and stands.
double PreferredVelocity::door_speed_factor(size_t slot, const Eigen::Vector2d& direction) {
  uint8_t& waits_at_door = state_.decisions.next_waits_at_door[slot];
  waits_at_door = 0;
  const uint32_t id = state_.id(slot);
  const Eigen::Vector2d& position = state_.agents[slot].position_m;
  if (direction.isZero() || !journeys_.field(id).is_closed(position)) return 1;
  const double radius_m = state_.agents[slot].radius_m;
  double free_path_m = door_controller_.free_path_m(position, direction, radius_m);
  for (const uint32_t other : state_.neighbours(slot)) {
    if (state_.agents[other].waits_at_door == 0) continue;
    const Eigen::Vector2d offset = state_.agents[other].position_m - position;
    const double distance_m = offset.norm();
    if (direction.dot(offset) < tuning::kBehindCosine * distance_m) continue;
    free_path_m = std::min(
        free_path_m, distance_m - radius_m - state_.agents[other].radius_m - tuning::kDoorGap_m);
  }
  const double factor = free_path_m / tuning::kBrakingDistance_m;
  if (factor >= 1) return 1;
  if (factor > tuning::kMinSpeedFactor) return factor;
  waits_at_door = 1;
  return 0;
}

}  // namespace throng
