#include "crowd/progress.h"

#include <algorithm>
#include <optional>

#include "crowd/crowd_tuning.h"

namespace throng {

double Progress::watch(size_t slot) {
  AgentState& w = state_.agents[slot];
  const uint32_t id = state_.id(slot);
  const bool goes = journeys_.state(id) == JourneyState::kWalking || queues_.is_awaited(id);
  const bool stands = !goes || w.waits_at_door != 0 || social_groups_.waits(id);
  if (stands || (w.position_m - w.anchor_m).squaredNorm() >= tuning::kStall_m * tuning::kStall_m) {
    w.anchor_m = w.position_m;
    w.anchor_step = state_.steps;
    w.queued_steps = 0;
  }
  state_.agents.queuing[slot] = is_queuing(slot);
  if (state_.agents.queuing[slot] != 0) w.queued_steps += state_.steps_per_period;
  const double stuck_s = std::max(
      0.0, state_.step_s * static_cast<double>(state_.steps - w.anchor_step - w.queued_steps));
  state_.agents.stall_cause[slot] = static_cast<uint8_t>(stall_cause(slot, stuck_s));
  publish_state(slot);
  return stuck_s;
}

/// Publishes for how long an agent has made no progress, queuing or not.
void Progress::publish_state(size_t slot) {
  NeighbourState& published = state_.agents.published[slot];
  const double stalled_s = state_.stalled_s(slot);
  published.impatience = static_cast<float>(
      tuning::ramp(tuning::kImpatienceFrom_s, tuning::kImpatienceTo_s, stalled_s));
  const auto catch_up =
      static_cast<float>(tuning::ramp(tuning::kCatchUpFrom_s, tuning::kCatchUpTo_s, stalled_s));
  published.catch_up = std::max(
      catch_up, published.catch_up - static_cast<float>(state_.period_s / tuning::kCatchUpFor_s));
}

/// Returns whether an agent for which `blocks(slot)` is true is ahead within 60 degrees, at a gap
/// of at most tuning::kQueueGap_m.
template <typename Blocks>
bool Progress::is_behind_any(size_t slot, const Blocks& blocks) const {
  const Eigen::Vector2d& position = state_.agents[slot].position_m;
  std::optional<Eigen::Vector2d> direction;  // computed once a nearby agent blocks
  for (const uint32_t other : state_.neighbours(slot)) {
    const Eigen::Vector2d offset = state_.agents[other].position_m - position;
    const double reach_m =
        state_.agents[slot].radius_m + state_.agents[other].radius_m + tuning::kQueueGap_m;
    if (offset.squaredNorm() > reach_m * reach_m) return false;
    if (!blocks(other)) continue;
    if (!direction) direction = journeys_.direction(state_.id(slot), position);
    if (direction->dot(offset) > 0.5 * offset.norm()) return true;
  }
  return false;
}

StallCause Progress::stall_cause(size_t slot, double stuck_s) const {
  const uint32_t id = state_.id(slot);
  if (journeys_.walks_to_stay(id) && is_slow(slot)) {
    const Stop& stop = journeys_.stop(id);
    const bool is_behind = is_behind_any(slot, [&](uint32_t other) {
      const Stop& its = journeys_.stop(state_.id(other));
      return journeys_.is_staying(state_.id(other)) && its.field == stop.field &&
             (its.is_narrow() || !its.contains(state_.agents[other].position_m));
    });
    if (is_behind) return StallCause::kBehindStaying;
  }
  return stuck_s >= tuning::kPatience_s ? StallCause::kStuck : StallCause::kNone;
}

bool Progress::is_queuing(size_t slot) const {
  const uint32_t id = state_.id(slot);
  if (journeys_.state(id) == JourneyState::kQueuing) return true;
  if (journeys_.state(id) != JourneyState::kWalking || !is_slow(slot)) return false;
  const FlowField* field = &journeys_.field(id);
  return is_behind_any(slot, [&](uint32_t other) {
    const uint32_t other_id = state_.id(other);
    return journeys_.state(other_id) == JourneyState::kWalking &&
           &journeys_.field(other_id) == field;
  });
}

bool Progress::is_slow(size_t slot) const {
  const double slow_mps = tuning::kQueueSpeed * state_.agents[slot].desired_speed_mps;
  return state_.agents[slot].velocity_mps.squaredNorm() <= slow_mps * slow_mps;
}

}  // namespace throng
