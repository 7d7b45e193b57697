#include "crowd/crowd.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/portable_math.h"
#include "crowd/crowd_tuning.h"

namespace throng {

Crowd::Crowd(NavigationMap& map, std::span<const AgentSpec> people, const CrowdOptions& options,
             Workers& workers)
    : map_(map),
      options_(options),
      model_(make_steering_model(options.steering.model, options.simd)),
      state_(map.walkable().ground(), people, options.step_s, model_->traits(), options.simd,
             workers),
      detours_(map, workers),
      journeys_(map, detours_, people, options.seed),
      population_(map, people, options.seed),
      triggers_(map, people),
      door_controller_(map, state_.radii_m, workers),
      exits_(map, people, options.seed),
      social_groups_(map, people),
      queues_(map, people),
      progress_(state_, journeys_, social_groups_, queues_),
      preferred_(state_, journeys_, social_groups_, door_controller_, options.seed),
      avoidance_(state_, *model_, map.walkable(), options.steering.density_dependent_speed),
      relaxation_(state_, map.walkable()),
      turning_(state_, journeys_, social_groups_, queues_, people) {
  for (const AgentSpec& person : people) {
    radius_scales_.push_back(person.radius_scale);
    enters_mps_.push_back(static_cast<float>(person.enters_mps.value_or(-1)));
    is_own_.push_back(person.is_external ? 0 : 1);
  }
  carried_.resize(people.size());
  block_displacements_m_.resize(state_.block_values.size() + 1, 0);
  rebuild_slots();
}

/// Assigns slots in the order of cells and moves each agent's state along.
void Crowd::rebuild_slots() {
  state_.grid.rebuild(state_.positions_m, population_.present());
  assign_slots();
}

void Crowd::assign_slots() {
  std::swap(state_.agents, carried_);
  state_.for_slots([this](size_t begin, size_t end, int) {
    std::array<uint32_t, kAgentsPerBlock> from;
    for (size_t slot = begin; slot < end; ++slot) {
      const uint32_t before = state_.slot_of[state_.id(slot)];
      from[slot - begin] = before == SteeringState::kNowhere ? 0 : before;
    }
    state_.agents.carry(carried_, {from.data(), end - begin}, begin);
    for (size_t slot = begin; slot < end; ++slot) {
      if (state_.slot_of[state_.id(slot)] == SteeringState::kNowhere) start_walking(slot);
      state_.publish_state(slot);
    }
  });
  if (population_.is_open())
    std::fill(state_.slot_of.begin(), state_.slot_of.end(), SteeringState::kNowhere);
  state_.for_slots([this](size_t begin, size_t end, int) {
    for (size_t slot = begin; slot < end; ++slot)
      state_.slot_of[state_.id(slot)] = static_cast<uint32_t>(slot);
  });
  state_.list_deciders([this](uint32_t id) { return social_groups_.first_member(id); });
}

/// Speed at which an agent enters: that of its source, or what agents ahead allow.
double Crowd::entering_mps(size_t slot) {
  // Single file: 0.36 m plus 1.06 s of speed (Seyfried, Steffen, Klingsch & Boltes, 2005).
  constexpr double kSpacing_m = 0.36, kHeadway_s = 1.06, kReach_m = 2.5;
  const uint32_t id = state_.id(slot), of[] = {static_cast<uint32_t>(slot)};
  if (enters_mps_[id] >= 0) return static_cast<double>(enters_mps_[id]);
  state_.grid.nearest(of, static_cast<float>(kReach_m), state_.decisions.neighbours.data(),
                      state_.decisions.neighbour_counts.data());
  double max_mps = state_.desired_speeds_mps[id];
  for (const uint32_t near : state_.neighbours(slot)) {
    const uint32_t other = state_.id(near);
    if (state_.slot_of[other] == SteeringState::kNowhere) continue;  // also enters now
    const Eigen::Vector2d& direction = state_.headings[id];
    const Eigen::Vector2d offset = state_.positions_m[other] - state_.positions_m[id];
    const double ahead_m = offset.dot(direction);
    const double aside_m = std::abs(direction.x() * offset.y() - direction.y() * offset.x());
    if (ahead_m <= 0 || aside_m > state_.radii_m[id] + state_.radii_m[other]) continue;
    max_mps = std::min(max_mps, std::max(state_.velocities_mps[other].dot(direction),
                                         (ahead_m - kSpacing_m) / kHeadway_s));
  }
  return std::max(max_mps, 0.0);
}

/// Agents that enter already walk, unless they stand too close together.
void Crowd::start_walking(size_t slot) {
  const uint32_t id = state_.id(slot);
  const bool may_walk = radius_scales_[id] == 1 || enters_mps_[id] >= 0;
  const bool walks = journeys_.state(id) == JourneyState::kWalking && may_walk;
  AgentState& w = state_.agents[slot];
  w.radius_m = state_.radii_m[id];
  w.desired_speed_mps = state_.desired_speeds_mps[id];
  w.position_m = w.anchor_m = state_.positions_m[id];
  w.heading = state_.headings[id];
  state_.velocities_mps[id] =
      walks ? Eigen::Vector2d(entering_mps(slot) * state_.headings[id]) : Eigen::Vector2d::Zero();
  w.velocity_mps = w.smooth_mps = w.old_mps = w.next_mps = w.smoothed_preferred_mps =
      state_.velocities_mps[id];
  w.drift_mps.setZero();
  w.facing.setZero();
  w.lateral_offset_m = 0;
  w.turn_radps = 0;
  w.clearance_m = 0;
  w.target_head_yaw_rad = w.head_yaw_radps = state_.head_yaws_rad[id] = 0;
  w.anchor_step = state_.steps;
  w.queued_steps = 0;
  state_.agents.queuing[slot] = state_.agents.stall_cause[slot] = 0;
  w.waits_at_door = 0;
  w.radius_scale = radius_scales_[id];
  state_.agents.published[slot].impatience = state_.agents.published[slot].catch_up = 0;
  state_.set_preferred(slot, state_.velocities_mps[id].cast<float>());
}

void Crowd::archive(Archive& a) {
  map_.archive(a);
  a(state_.steps, state_.positions_m, state_.headings, state_.displacements_m,
    state_.desired_speeds_mps, state_.max_desired_speed_mps, enters_mps_);
  archive_added(a);
  a(detours_, journeys_, population_, triggers_, door_controller_, exits_, social_groups_,
    counters_);
  queues_.archive(a, journeys_);
  state_.grid.archive(a);
  if (a.is_reading()) {
    for (uint32_t id = 0; id < size(); ++id)
      if (!state_.positions_m[id].allFinite() ||
          (journeys_.is_present(id) && !map_.walkable().ground().contains(state_.positions_m[id])))
        a.reject("a place on the ground", "one outside");
    std::fill(state_.slot_of.begin(), state_.slot_of.end(), SteeringState::kNowhere);
    state_.grid.rebuild_as_read(state_.positions_m);
    for (const uint32_t id : added_) state_.grid.insert(id, state_.positions_m[id]);
    assign_slots();
  }
  state_.archive_agents(a);
}

void Crowd::step() {
  constexpr size_t kAhead = 8;
  if (size() == 0) return;
  const auto phase = static_cast<int>(state_.steps % state_.steps_per_period);
  if (phase == 0) begin_period();
  decide(phase);
  state_.for_slots([this](size_t begin, size_t end, int) {
    double turned_rad = 0, farthest_m = 0;
    for (size_t slot = begin; slot < end; ++slot) {
      if (slot + kAhead < end) state_.prefetch_agent(state_.grid.order()[slot + kAhead]);
      farthest_m = std::max(farthest_m, move(slot));
      turned_rad += turning_.step(slot);
    }
    state_.block_values[begin / kAgentsPerBlock] = turned_rad;
    block_displacements_m_[begin / kAgentsPerBlock] = farthest_m;
  });
  const auto blocks = static_cast<size_t>(block_count(state_.grid.order().size()));
  block_displacements_m_[blocks] = move_added();
  for (size_t block = 0; block < blocks; ++block)
    counters_.turned_rad += state_.block_values[block];
  state_.grid.add_slack_m(
      *std::max_element(block_displacements_m_.begin(),
                        block_displacements_m_.begin() + static_cast<ptrdiff_t>(blocks) + 1));
  counters_.walked_s += state_.step_s * static_cast<double>(state_.grid.order().size());
  ++state_.steps;
}

void Crowd::decide() {
  begin_period();
  for (int phase = 0; phase < state_.steps_per_period; ++phase) decide(phase);
}

void Crowd::begin_period() {
  added_.clear();
  update_population();
  rebuild_slots();
}

void Crowd::update_detours() {
  detours_.update(
      state_.periods(), state_.grid.order().size(),
      [this](size_t slot) {
        constexpr double kMinSpeed_mps = 0.1;  // of externally controlled agents
        return Detours::AgentSample{
            state_.agents[slot].position_m,
            state_.agents[slot].velocity_mps /
                std::max(state_.agents[slot].desired_speed_mps, kMinSpeed_mps)};
      },
      state_.workers);
}

void Crowd::decide(int phase) {
  state_.phase = static_cast<size_t>(phase);
  // Not in the step that begins a period, which is the most expensive one.
  if (phase == state_.steps_per_period / 2) update_detours();
  if (social_groups_.any()) {
    state_.for_deciders([this](Slots slots, size_t, int) { find_neighbours(slots); });
    social_groups_.update(static_cast<uint32_t>(phase),
                          static_cast<uint32_t>(state_.steps_per_period), journeys_,
                          state_.positions_m, state_.now_s(), state_.workers);
  }
  counters_.longest_stall_s = state_.max_over_blocks(
      [this](Slots slots, size_t) { return update_preferred_velocities(slots); });
  counters_.queuing = 0;
  for (size_t slot = 0; slot < state_.grid.order().size(); ++slot)
    counters_.queuing += state_.agents.queuing[slot];
  avoidance_.choose();
  if (door_controller_.has_doors())
    state_.for_deciders([this](Slots slots, size_t, int) { preferred_.publish_waiting(slots); });
  relaxation_.relax(counters_);
  ++counters_.rounds;
  counters_.decisions += state_.deciders().size();
}

/// Updates journeys and the population before agents look for neighbours.
void Crowd::update_population() {
  const double now_s = state_.now_s();
  for_blocks_of(state_.workers, size(), [&](size_t begin, size_t end, int) {
    for (size_t id = begin; id < end; ++id) {
      const uint32_t slot = state_.slot_of[id];
      const auto stall_cause = slot == SteeringState::kNowhere
                                   ? StallCause::kNone
                                   : static_cast<StallCause>(state_.agents.stall_cause[slot]);
      journeys_.follow(static_cast<uint32_t>(id), state_.positions_m[id], now_s, stall_cause);
    }
  });
  if (!map_.triggers().empty()) {
    triggers_.watch(journeys_, now_s);
    for (size_t group = 0; group < map_.groups(); ++group)
      if (const std::optional<uint32_t> after = map_.after(group))
        journeys_.allow_departure(group, triggers_.time_s(*after));
  }
  if (door_controller_.has_doors())
    door_controller_.follow(triggers_, population_.present(), state_.positions_m, now_s);
  if (population_.is_open()) {
    population_.release(journeys_);
    population_.admit(now_s, journeys_, state_.positions_m);
  }
  if (exits_.has_any())
    exits_.choose(state_.periods(), state_.positions_m, state_.grid.order(), state_.agents.queuing,
                  journeys_, state_.workers);
  if (queues_.any())
    queues_.follow(population_.present(), state_.positions_m, journeys_, state_.workers);
  for (const uint32_t id : population_.entered()) {
    const Eigen::Vector2d direction = journeys_.direction(id, state_.positions_m[id]);
    if (direction.squaredNorm() > 0) state_.headings[id] = direction;
  }
}

void Crowd::find_neighbours(Slots slots) {
  preferred_.prepare(slots);
  state_.grid.nearest(slots, static_cast<float>(tuning::kReach_m),
                      state_.decisions.neighbours.data(), state_.decisions.neighbour_counts.data());
  if (social_groups_.any()) social_groups_.find_neighbours(state_, slots);
}

/// Runs the decision passes that treat agents independently. Returns the longest stall (s).
double Crowd::update_preferred_velocities(Slots slots) {
  if (!social_groups_.any()) find_neighbours(slots);
  double longest_s = 0;
  for (const uint32_t slot : slots) {
    AgentState& w = state_.agents[slot];
    w.old_mps = w.velocity_mps;
    longest_s = std::max(longest_s, progress_.watch(slot));
    preferred_.decide(slot);
    relaxation_.grow(slot, journeys_.state(state_.id(slot)) == JourneyState::kWalking);
    state_.publish_state(slot);
    turning_.decide(slot);
    avoidance_.prepare(slot);
  }
  return longest_s;
}

void Crowd::override_motion(uint32_t id, const Eigen::Vector2d& position_m,
                            const Eigen::Vector2d& heading, const Eigen::Vector2d& velocity_mps) {
  const double displacement_m = (position_m - state_.positions_m[id]).norm();
  state_.displacements_m[id] = displacement_m;
  state_.positions_m[id] = position_m;
  state_.headings[id] = heading;
  state_.velocities_mps[id] = velocity_mps;
  const uint32_t slot = state_.slot_of[id];
  if (slot == SteeringState::kNowhere) {
    if (journeys_.is_present(id)) state_.grid.insert(id, position_m);
    return;
  }
  AgentState& w = state_.agents[slot];
  w.position_m = position_m;
  w.heading = heading;
  w.velocity_mps = w.smooth_mps = w.smoothed_preferred_mps = velocity_mps;
  w.old_mps = w.next_mps = velocity_mps;
  w.drift_mps.setZero();
  w.turn_radps = 0;
  state_.grid.move(slot, position_m);
  state_.grid.add_slack_m(displacement_m);
  state_.publish_state(slot);
  // An externally controlled agent is never stuck.
  w.anchor_m = position_m;
  w.anchor_step = state_.steps;
}

/// Heading on entry.
Eigen::Vector2d Crowd::heading_of(uint32_t id, const AgentEntry& entry) const {
  if (std::isfinite(entry.heading_rad)) {
    const SinCos turn = sin_cos(entry.heading_rad);
    return {turn.cos, turn.sin};
  }
  Eigen::Vector2d along = journeys_.direction(id, entry.position_m);
  if (!along.isZero()) return along;
  const Eigen::Vector2d facing = journeys_.facing(id, entry.position_m);
  return facing.isZero() ? state_.headings[id] : facing;
}

uint32_t Crowd::add(size_t group, std::span<const AgentEntry> entries) {
  const uint32_t first = population_.first_spare(group);
  assert(entries.size() <= population_.spares(group));
  population_.add_spares(group, static_cast<uint32_t>(entries.size()));
  const FlowField& field = *map_.route(group).front().field;
  constexpr size_t kAhead = 8;
  for (uint32_t i = 0; i < entries.size(); ++i) {
    const AgentEntry& entry = entries[i];
    if (i + kAhead < entries.size()) field.prefetch(entries[i + kAhead].position_m);
    const uint32_t id = first + i;
    state_.positions_m[id] = entry.position_m;
    journeys_.enter(id, entry.position_m, state_.now_s());
    state_.headings[id] = heading_of(id, entry);
    state_.velocities_mps[id] = entry.speed_mps * state_.headings[id];
    enters_mps_[id] = static_cast<float>(entry.speed_mps);
    added_.push_back(id);
    state_.grid.insert(id, entry.position_m);
  }
  return first;
}

std::optional<uint32_t> Crowd::find_overlapping(const Eigen::Vector2d& point,
                                                double radius_m) const {
  std::optional<uint32_t> found;
  state_.grid.visit_near(point, min_apart_m(radius_m, max_radius_m()), [&](uint32_t id) {
    const double apart_m = min_apart_m(radius_m, state_.radii_m[id]);
    if (journeys_.is_present(id) && (state_.positions_m[id] - point).norm() < apart_m)
      found = std::min(id, found.value_or(id));
  });
  return found;
}

void Crowd::remove(uint32_t id) {
  queues_.remove(id, journeys_.state(id) == JourneyState::kQueuing);
  population_.remove(id);
  journeys_.leave(id);
  exits_.forget(id);
  const uint32_t slot = state_.slot_of[id];
  if (slot == SteeringState::kNowhere) return;
  AgentState& w = state_.agents[slot];
  w.old_mps = w.next_mps = w.velocity_mps = w.drift_mps = Eigen::Vector2d::Zero();
}

void Crowd::set_goal(std::span<const uint32_t> ids, const Goal& goal) {
  std::vector<size_t> groups;
  for (const uint32_t id : ids) groups.push_back(map_.group_of(journeys_.route(id)));
  std::vector<uint8_t> is_used = journeys_.routes_in_use();
  std::vector<size_t> routes(map_.groups(), 0);  // of the goal, by group; 0: none yet
  for (const size_t group : groups) {
    if (routes[group] != 0) continue;
    routes[group] = map_.route_to(group, goal, is_used);
    is_used.resize(map_.routes(), 1);
    is_used[routes[group]] = 1;
  }
  for (size_t i = 0; i < ids.size(); ++i) {
    queues_.remove(ids[i], journeys_.state(ids[i]) == JourneyState::kQueuing);
    exits_.forget(ids[i]);
    social_groups_.forget_progress(ids[i]);
    journeys_.take_route(ids[i], routes[groups[i]], state_.positions_m[ids[i]]);
  }
}

void Crowd::set_desired_speed(uint32_t id, double mps) {
  state_.desired_speeds_mps[id] = mps;
  state_.max_desired_speed_mps = std::max(state_.max_desired_speed_mps, mps);
  if (const uint32_t slot = state_.slot_of[id]; slot != SteeringState::kNowhere)
    state_.agents[slot].desired_speed_mps = mps;
  exits_.set_desired_speed(id, mps);
}

/// Agents without a slot walk straight on. Returns the largest displacement (m).
double Crowd::move_added() {
  double farthest_m = 0;
  for (const uint32_t id : added_) {
    if (!journeys_.is_present(id)) continue;
    const Eigen::Vector2d from = state_.positions_m[id];
    state_.positions_m[id] = map_.walkable().slide(
        from, from + state_.step_s * state_.velocities_mps[id], tuning::kWallGap_m);
    state_.displacements_m[id] = (state_.positions_m[id] - from).norm();
    farthest_m = std::max(farthest_m, state_.displacements_m[id]);
  }
  return farthest_m;
}

void Crowd::archive_added(Archive& a) {
  a.resized(added_, size());
  for (const uint32_t id : added_)
    if (id >= size()) a.reject("the id of an agent", "another number");
  constexpr double kMaxSpeed_mps = 100;
  if (!(state_.max_desired_speed_mps <= kMaxSpeed_mps))
    a.reject("a possible desired speed", "another value");
  // Negated to reject NaN as well.
  for (const float mps : enters_mps_)
    if (!(mps >= -1 && mps <= static_cast<float>(kMaxEntrySpeed_mps)))
      a.reject("the speed of an agent", "another value");
  for (size_t id = 0; id < size() && a.is_reading(); ++id) {
    const double mps = state_.desired_speeds_mps[id];
    if (!(mps >= (is_own_[id] != 0 ? kMinDesiredSpeed_mps : 0) &&
          mps <= state_.max_desired_speed_mps))
      a.reject("the desired speed of an agent", "another value");
    exits_.set_desired_speed(static_cast<uint32_t>(id), mps);
  }
}

void Crowd::set_present(uint32_t id, bool is_there) {
  population_.set_present(id, is_there);
  journeys_.set_present(id, is_there);
}

/// Returns the displacement (m). The velocity reaches the chosen one within the agent's period.
double Crowd::move(size_t slot) {
  AgentState& w = state_.agents[slot];
  const size_t steps = static_cast<size_t>(state_.steps_per_period);
  const auto part =
      static_cast<double>((state_.phase + steps - state_.decisions.phase[slot]) % steps);
  const Eigen::Vector2d change = w.next_mps - w.old_mps;
  const Eigen::Vector2d midway =
      w.old_mps + (part + 0.5) / state_.steps_per_period * change + w.drift_mps;
  w.velocity_mps = w.old_mps + (part + 1) / state_.steps_per_period * change;
  const Eigen::Vector2d from = w.position_m;
  Eigen::Vector2d to = from + state_.step_s * midway;
  // An agent this far from walls at its decision reaches none before the next.
  const double reach_m =
      state_.period_s * (2 * tuning::kMaxSpeedFactor * w.desired_speed_mps + tuning::kMaxDrift_mps);
  if (w.clearance_m < reach_m + tuning::kWallGap_m)
    to = map_.walkable().slide(from, to, tuning::kWallGap_m);
  const uint32_t id = state_.id(slot);
  if (queues_.any()) to = queues_.keep_out(id, from, to, journeys_);
  w.position_m = to;
  state_.positions_m[id] = to;
  state_.velocities_mps[id] = w.velocity_mps;
  state_.grid.move(slot, to);
  state_.publish_state(slot);
  const double displacement_m = (to - from).norm();
  state_.displacements_m[id] = displacement_m;
  return displacement_m;
}

}  // namespace throng
