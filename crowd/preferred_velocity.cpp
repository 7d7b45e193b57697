#include "crowd/preferred_velocity.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "crowd/crowd_tuning.h"

namespace throng {

void PreferredVelocity::prepare(SteeringState::Slots slots) {
  // The fields are too large for the caches: fetched now, they are there after the search.
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    const uint32_t later = state_.later_decider(slots, i);
    state_.agents.prefetch(later, sizeof(AgentState));
    journeys_.prefetch(state_.id(later));
    state_.agents[slot].own_side_m = own_side_m(slot);
    journeys_.prefetch(state_.id(slot), state_.agents[slot].position_m, own_side(slot));
  }
}

void PreferredVelocity::decide(size_t slot) {
  state_.set_preferred(slot, wanted_mps(slot).cast<float>());
}

void PreferredVelocity::show_held(SteeringState::Slots slots) {
  for (const uint32_t slot : slots) state_.agents[slot].held = state_.decisions.next_held[slot];
}

Eigen::Vector2d PreferredVelocity::wanted_mps(size_t slot) {
  const uint32_t id = state_.id(slot);
  const bool has_companions =
      parties_.has(id) && journeys_.doing(id) != Doing::kQueuing;  // each has a place of their own
  Eigen::Vector2d direction =
      has_companions ? parties_.alone(id)
                     : journeys_.direction(id, state_.agents[slot].position_m, own_side(slot),
                                           state_.agents[slot].clearance_m);
  state_.agents[slot].facing = direction;
  const double room = doorkeeper_.has_doors() ? pace_before_door(slot, direction) : 1;
  if (has_companions) direction = parties_.way(id);
  if (room != 1) direction *= room;
  const double stalled_s = state_.stalled_s(slot);
  if (state_.traits.is_nudged && stalled_s > tuning::kStuck_s) {
    const auto second = static_cast<uint64_t>(std::floor(stalled_s));
    const RandomKey key{seed_, id, static_cast<uint64_t>(state_.agents[slot].anchor_step) + second,
                        Purpose::kSymmetryBreaking};
    const double side = random_uniform(key, -tuning::kSidestep, tuning::kSidestep, 2);
    direction += side * Eigen::Vector2d(-direction.y(), direction.x());
    if (direction.squaredNorm() > 0) direction.normalize();
  }
  if (has_companions) direction *= parties_.pace(id);
  const double share =
      state_.traits.eases ? 1 : state_.period_s / (tuning::kRelaxation_s + state_.period_s);
  Eigen::Vector2d& intent = state_.agents[slot].intent_mps;
  intent += share * (state_.agents[slot].free_speed_mps * direction - intent);
  const RandomKey key{seed_, id, static_cast<uint64_t>(state_.steps), Purpose::kSymmetryBreaking};
  // One draw for both axes: half of its bits are plenty.
  const uint64_t bits = random_bits(key);
  const auto shake = [](uint64_t half) {
    return tuning::kPerturbation_mps * (static_cast<double>(half) * 0x1.0p-31 - 1);
  };
  return intent + Eigen::Vector2d(shake(bits & 0xffffffff), shake(bits >> 32));
}

/// How far to the left of the shortest way somebody walks, less than nothing to the right: to a
/// side of their own, as far as walls leave room and their pace does, and not all at once.
double PreferredVelocity::own_side_m(size_t slot) const {
  if (!state_.traits.keeps_sides) return 0;
  const double room_m = std::max(state_.agents[slot].clearance_m - tuning::kOwnSideFrom_m, 0.0);
  const double pace = state_.agents[slot].velocity_mps.norm() / state_.agents[slot].free_speed_mps;
  const double share = tuning::share_between(tuning::kOwnSideSlow, tuning::kOwnSideFast, pace);
  const RandomKey key{seed_, state_.id(slot), 0, Purpose::kOwnSide};
  const double side_m = share * random_uniform(key, -room_m, room_m);
  const double most_m = tuning::kOwnSideRate_mps * state_.period_s,
               now_m = state_.agents[slot].own_side_m;
  return std::clamp(side_m, now_m - most_m, now_m + most_m);
}

/// The share of the free speed that is left to somebody whose way leads through a closed door:
/// they come up to it, or behind others who wait for it, and stand.
double PreferredVelocity::pace_before_door(size_t slot, const Eigen::Vector2d& way) {
  uint8_t& held = state_.decisions.next_held[slot];
  held = 0;
  const uint32_t id = state_.id(slot);
  const Eigen::Vector2d& position = state_.agents[slot].position_m;
  if (way.isZero() || !journeys_.field(id).is_closed(position)) return 1;
  const double radius_m = state_.agents[slot].radius_m;
  double room_m = doorkeeper_.room_m(position, way, radius_m);
  for (const uint32_t other : state_.neighbours(slot)) {
    if (state_.agents[other].held == 0) continue;
    const Eigen::Vector2d offset = state_.agents[other].position_m - position;
    const double distance_m = offset.norm();
    if (way.dot(offset) < tuning::kBehind * distance_m) continue;
    room_m =
        std::min(room_m, distance_m - radius_m - state_.agents[other].radius_m - tuning::kWaits_m);
  }
  const double pace = room_m / tuning::kBrakes_m;
  if (pace >= 1) return 1;
  if (pace > tuning::kCreeps) return pace;
  held = 1;
  return 0;
}

}  // namespace throng
