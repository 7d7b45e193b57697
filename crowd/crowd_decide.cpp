// How people decide where to go next: who is near, walls, and the steering model's choice.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "crowd/crowd.h"
#include "crowd/crowd_tuning.h"

namespace throng {

void Crowd::decide() {
  begin_period();
  for (int phase = 0; phase < state_.steps_per_period; ++phase) decide(phase);
}

/// What is for everybody at once.
void Crowd::begin_period() {
  change_people();
  seat_people();
}

void Crowd::update_detours() {
  detours_.update(
      state_.periods(), state_.grid.order().size(),
      [this](size_t slot) {
        constexpr double kLeast_mps = 0.1;  // of those who are led
        return Detours::Walker{state_.agents[slot].position_m,
                               state_.agents[slot].velocity_mps /
                                   std::max(state_.agents[slot].free_speed_mps, kLeast_mps)};
      },
      state_.workers);
}

/// Those of a phase look around, wish, choose and are kept out of each other.
void Crowd::decide(int phase) {
  state_.phase = static_cast<size_t>(phase);
  // Not in the frame that begins a period: that takes the most time as it is.
  if (phase == state_.steps_per_period / 2) update_detours();
  if (parties_.any()) {
    state_.for_deciders([this](Slots slots, size_t, int) { look_around(slots); });
    parties_.gather(static_cast<uint32_t>(phase), static_cast<uint32_t>(state_.steps_per_period),
                    journeys_, state_.positions_m, state_.now_s(), state_.workers);
  }
  counters_.longest_stall_s = state_.largest([this](Slots slots, size_t) { return wish(slots); });
  counters_.queuing = 0;
  for (size_t slot = 0; slot < state_.grid.order().size(); ++slot)
    counters_.queuing += state_.agents.queuing[slot];
  avoidance_.choose();
  if (doorkeeper_.has_doors())
    state_.for_deciders([this](Slots slots, size_t, int) {
      for (const uint32_t slot : slots) state_.agents[slot].held = state_.decisions.next_held[slot];
    });
  relaxation_.relax(counters_);
  ++counters_.rounds;
  counters_.decisions += state_.deciders().size();
}

/// Goals are reached, and people come and go, before anybody looks around.
void Crowd::change_people() {
  const double now_s = state_.now_s();
  // By id, as what journeys know is.
  for_people(state_.workers, size(), [&](size_t begin, size_t end, int) {
    for (size_t id = begin; id < end; ++id) {
      const uint32_t slot = state_.slot_of[id];
      const auto held_up = slot == CrowdState::kNowhere
                               ? HeldUp::kNot
                               : static_cast<HeldUp>(state_.agents.held_up[slot]);
      journeys_.follow(static_cast<uint32_t>(id), state_.positions_m[id], now_s, held_up);
    }
  });
  if (!ways_.occasions().empty()) {
    occasions_.watch(journeys_, now_s);
    for (size_t group = 0; group < ways_.groups(); ++group)
      if (const std::optional<uint32_t> after = ways_.after(group))
        journeys_.let_go(group, occasions_.time_s(*after));
  }
  if (doorkeeper_.has_doors())
    doorkeeper_.follow(occasions_, traffic_.present(), state_.positions_m, now_s);
  if (traffic_.is_open()) {
    traffic_.release(journeys_);
    traffic_.admit(now_s, journeys_, state_.positions_m);
  }
  if (exits_.has_any())
    exits_.choose(state_.periods(), state_.positions_m, state_.grid.order(), state_.agents.queuing,
                  journeys_, state_.workers);
  if (queues_.any())
    queues_.follow(traffic_.present(), state_.positions_m, journeys_, state_.workers);
  for (const uint32_t id : traffic_.entered()) {
    const Eigen::Vector2d way = journeys_.direction(id, state_.positions_m[id]);
    if (way.squaredNorm() > 0) state_.headings[id] = way;
  }
}

void Crowd::look_around(Slots slots) {
  // The fields are too large for the caches: fetched now, they are there after the search.
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    const uint32_t later = state_.later_decider(slots, i);
    state_.agents.prefetch(later, sizeof(AgentState));
    journeys_.prefetch(state_.id(later));
    state_.agents[slot].own_side_m = own_side_m(slot);
    journeys_.prefetch(state_.id(slot), state_.agents[slot].position_m, own_side(slot));
  }
  state_.grid.nearest(slots, static_cast<float>(tuning::kReach_m),
                      state_.decisions.neighbours.data(), state_.decisions.neighbour_counts.data());
  if (!parties_.any()) return;
  for (const uint32_t slot : slots) {
    const uint32_t id = state_.id(slot);
    if (!parties_.has(id)) continue;
    parties_.see(id, strangers_per_m2(slot));
    overlook_companions(slot);
  }
}

/// Companions who walk beside each other do not avoid each other: each knows where the other goes.
/// Who comes too near is seen again.
void Crowd::overlook_companions(size_t slot) {
  const auto walks_beside = [&](uint32_t other) {
    if (!parties_.are_companions(state_.id(slot), state_.id(other))) return false;
    const Eigen::Vector2d offset = state_.agents[other].position_m - state_.agents[slot].position_m;
    const Eigen::Vector2d both_mps =
        state_.agents[slot].velocity_mps + state_.agents[other].velocity_mps;
    const double along = std::abs(offset.dot(both_mps)), square_m2 = offset.squaredNorm();
    const double gap_m =
        state_.agents[slot].radius_m + state_.agents[other].radius_m + tuning::kBesideGap_m;
    return both_mps.squaredNorm() > tuning::kBeside_mps * tuning::kBeside_mps &&
           square_m2 > gap_m * gap_m && 2 * along * along < square_m2 * both_mps.squaredNorm();
  };
  uint32_t* near = state_.decisions.neighbours.data() + CrowdState::kMaxNeighbours * slot;
  uint8_t& count = state_.decisions.neighbour_counts[slot];
  count = static_cast<uint8_t>(std::remove_if(near, near + count, walks_beside) - near);
}

/// Within two metres beside the way; those farther off, ahead and behind count less.
double Crowd::strangers_per_m2(size_t slot) const {
  constexpr double kReach_m = 2;
  const Eigen::Vector2d& intent = state_.agents[slot].intent_mps;
  const double speed = intent.norm();
  double sum = 0;
  for (size_t k = 0; k < state_.decisions.neighbour_counts[slot]; ++k) {
    const uint32_t other = state_.decisions.neighbours[CrowdState::kMaxNeighbours * slot + k];
    if (parties_.are_companions(state_.id(slot), state_.id(other))) continue;
    const Eigen::Vector2d offset = state_.agents[other].position_m - state_.agents[slot].position_m;
    const double away_m = offset.norm();
    const double ahead_m = speed > 0 ? offset.dot(intent) / speed : 0;
    const double aside = away_m > 0 ? 1 - ahead_m * ahead_m / (away_m * away_m) : 1;
    sum += 2 * aside * std::max(0.0, 1 - away_m / kReach_m);
  }
  // A cone of that radius, one high.
  return sum * 3 / (std::numbers::pi * kReach_m * kReach_m);
}

/// Returns the longest stall.
double Crowd::wish(Slots slots) {
  if (!parties_.any()) look_around(slots);
  double longest_s = 0;
  for (const uint32_t slot : slots) {
    AgentState& w = state_.agents[slot];
    Seen& seen = state_.agents.seen[slot];
    w.old_mps = w.velocity_mps;
    longest_s = std::max(longest_s, watch_progress(slot));
    state_.set_preferred(slot, wanted_mps(slot).cast<float>());
    const double stalled_s = state_.stalled_s(slot);
    seen.urge = static_cast<float>(
        tuning::share_between(tuning::kUrgeFrom_s, tuning::kUrgeTo_s, stalled_s));
    const auto eager = static_cast<float>(
        tuning::share_between(tuning::kEagerFrom_s, tuning::kEagerTo_s, stalled_s));
    seen.eagerness =
        std::max(eager, seen.eagerness - static_cast<float>(state_.period_s / tuning::kEagerFor_s));
    relaxation_.grow(slot, journeys_.doing(state_.id(slot)) == Doing::kWalking);
    state_.show(slot);
    turning_.decide(slot);
    avoidance_.prepare(slot);
  }
  return longest_s;
}

/// How long somebody has been stuck, the time of queuing taken off.
double Crowd::watch_progress(size_t slot) {
  AgentState& w = state_.agents[slot];
  const uint32_t id = state_.id(slot);
  const bool goes = journeys_.doing(id) == Doing::kWalking || queues_.is_awaited(id);
  const bool stands = !goes || w.held != 0 || parties_.waits(id);
  if (stands || (w.position_m - w.anchor_m).squaredNorm() >= kStall_m * kStall_m) {
    w.anchor_m = w.position_m;
    w.anchor_step = state_.steps;
    w.queued_steps = 0;
  }
  state_.agents.queuing[slot] = is_queuing(slot);
  if (state_.agents.queuing[slot] != 0) w.queued_steps += state_.steps_per_period;
  const double stuck_s = std::max(
      0.0, state_.step_s * static_cast<double>(state_.steps - w.anchor_step - w.queued_steps));
  state_.agents.held_up[slot] = static_cast<uint8_t>(held_up(slot, stuck_s));
  return stuck_s;
}

HeldUp Crowd::held_up(size_t slot, double stuck_s) const {
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

bool Crowd::is_slow(size_t slot) const {
  const double slow_mps = tuning::kQueueSpeed * state_.agents[slot].free_speed_mps;
  return state_.agents[slot].velocity_mps.squaredNorm() <= slow_mps * slow_mps;
}

/// Returns whether an agent for which `holds_up(slot)` is true is ahead of another within 60
/// degrees, at a gap of tuning::kQueueGap_m at most.
template <typename HoldsUp>
bool Crowd::is_behind_any(size_t slot, const HoldsUp& holds_up) const {
  const Eigen::Vector2d& position = state_.agents[slot].position_m;
  std::optional<Eigen::Vector2d> way;  // found when an agent near by holds up
  for (size_t k = 0; k < state_.decisions.neighbour_counts[slot]; ++k) {
    const uint32_t other = state_.decisions.neighbours[CrowdState::kMaxNeighbours * slot + k];
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

bool Crowd::is_queuing(size_t slot) const {
  const uint32_t id = state_.id(slot);
  if (journeys_.doing(id) == Doing::kQueuing) return true;
  if (journeys_.doing(id) != Doing::kWalking || !is_slow(slot)) return false;
  const FlowField* field = &journeys_.field(id);
  return is_behind_any(slot, [&](uint32_t other) {
    const uint32_t other_id = state_.id(other);
    return journeys_.doing(other_id) == Doing::kWalking && &journeys_.field(other_id) == field;
  });
}

}  // namespace throng
