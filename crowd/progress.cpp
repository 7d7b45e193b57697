#include "crowd/progress.h"

#include <algorithm>
#include <optional>

#include "crowd/crowd_tuning.h"

namespace throng {

double Progress::watch(size_t slot) {
  AgentState& w = state_.agents[slot];
  const uint32_t id = state_.id(slot);
  const bool goes = journeys_.doing(id) == Doing::kWalking || queues_.is_awaited(id);
  const bool stands = !goes || w.held != 0 || parties_.waits(id);
  if (stands || (w.position_m - w.anchor_m).squaredNorm() >= tuning::kStall_m * tuning::kStall_m) {
    w.anchor_m = w.position_m;
    w.anchor_step = state_.steps;
    w.queued_steps = 0;
  }
  state_.agents.queuing[slot] = is_queuing(slot);
  if (state_.agents.queuing[slot] != 0) w.queued_steps += state_.steps_per_period;
  const double stuck_s = std::max(
      0.0, state_.step_s * static_cast<double>(state_.steps - w.anchor_step - w.queued_steps));
  state_.agents.held_up[slot] = static_cast<uint8_t>(held_up(slot, stuck_s));
  show(slot);
  return stuck_s;
}

/// Others see how long an agent has made no progress, queuing or not.
void Progress::show(size_t slot) {
  Seen& seen = state_.agents.seen[slot];
  const double stalled_s = state_.stalled_s(slot);
  seen.urge =
      static_cast<float>(tuning::share_between(tuning::kUrgeFrom_s, tuning::kUrgeTo_s, stalled_s));
  const auto eager = static_cast<float>(
      tuning::share_between(tuning::kEagerFrom_s, tuning::kEagerTo_s, stalled_s));
  seen.eagerness =
      std::max(eager, seen.eagerness - static_cast<float>(state_.period_s / tuning::kEagerFor_s));
}

/// Returns whether an agent for which `holds_up(slot)` is true is ahead of another within 60
/// degrees, at a gap of tuning::kQueueGap_m at most.
template <typename HoldsUp>
bool Progress::is_behind_any(size_t slot, const HoldsUp& holds_up) const {
  const Eigen::Vector2d& position = state_.agents[slot].position_m;
  std::optional<Eigen::Vector2d> way;  // found when an agent near by holds up
  for (const uint32_t other : state_.neighbours(slot)) {
    const Eigen::Vector2d offset = state_.agents[other].position_m - position;
    const double reach_m =
        state_.agents[slot].radius_m + state_.agents[other].radius_m + tuning::kQueueGap_m;
    if (offset.squaredNorm() > reach_m * reach_m) return false;
    if (!holds_up(other)) continue;
    if (!way) way = journeys_.direction(state_.id(slot), position);
    if (way->dot(offset) > 0.5 * offset.norm()) return true;
  }
  return false;
}

HeldUp Progress::held_up(size_t slot, double stuck_s) const {
  const uint32_t id = state_.id(slot);
  if (journeys_.walks_to_stay(id) && is_slow(slot)) {
    const Stop& stop = journeys_.stop(id);
    const bool is_behind = is_behind_any(slot, [&](uint32_t other) {
      const Stop& its = journeys_.stop(state_.id(other));
      return journeys_.is_staying(state_.id(other)) && its.field == stop.field &&
             (its.is_narrow() || !its.contains(state_.agents[other].position_m));
    });
    if (is_behind) return HeldUp::kBehindStaying;
  }
  return stuck_s >= tuning::kPatience_s ? HeldUp::kStuck : HeldUp::kNot;
}

bool Progress::is_queuing(size_t slot) const {
  const uint32_t id = state_.id(slot);
  if (journeys_.doing(id) == Doing::kQueuing) return true;
  if (journeys_.doing(id) != Doing::kWalking || !is_slow(slot)) return false;
  const FlowField* field = &journeys_.field(id);
  return is_behind_any(slot, [&](uint32_t other) {
    const uint32_t other_id = state_.id(other);
    return journeys_.doing(other_id) == Doing::kWalking && &journeys_.field(other_id) == field;
  });
}

bool Progress::is_slow(size_t slot) const {
  const double slow_mps = tuning::kQueueSpeed * state_.agents[slot].free_speed_mps;
  return state_.agents[slot].velocity_mps.squaredNorm() <= slow_mps * slow_mps;
}

}  // namespace throng
