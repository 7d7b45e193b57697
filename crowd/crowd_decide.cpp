// How people decide where to go next: who is near, walls, and the steering model's choice.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "crowd/crowd.h"
#include "crowd/crowd_tuning.h"
#include "crowd/steering/collision_free_speed.h"

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
  if (limits_wishes())
    state_.for_deciders([this](Slots slots, size_t, int worker) {
      limit_wishes(slots, walls_[static_cast<size_t>(worker)]);
    });
  state_.for_deciders([this](Slots slots, size_t, int worker) {
    choose(slots, walls_[static_cast<size_t>(worker)]);
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
    const double stalled_s = stalled_s_of(slot);
    seen.urge = static_cast<float>(
        tuning::share_between(tuning::kUrgeFrom_s, tuning::kUrgeTo_s, stalled_s));
    const auto eager = static_cast<float>(
        tuning::share_between(tuning::kEagerFrom_s, tuning::kEagerTo_s, stalled_s));
    seen.eagerness =
        std::max(eager, seen.eagerness - static_cast<float>(state_.period_s / tuning::kEagerFor_s));
    relaxation_.grow(slot, journeys_.doing(state_.id(slot)) == Doing::kWalking);
    state_.show(slot);
    turning_.decide(slot);
    seen.max_speed_mps = static_cast<float>(tuning::kHaste * w.free_speed_mps);
    seen.horizon_s = static_cast<float>(stalled_s > tuning::kStuck_s ? tuning::kStuckHorizon_s
                                                                     : tuning::kHorizon_s);
  }
  return longest_s;
}

SteeringView Crowd::view() const {
  SteeringView view;
  view.seen = state_.agents.seen.data();
  view.neighbours = state_.decisions.neighbours.data();
  view.neighbour_counts = state_.decisions.neighbour_counts.data();
  view.period_s = static_cast<float>(state_.period_s);
  view.wall_horizon_s = static_cast<float>(tuning::kWallHorizon_s);
  return view;
}

SteeringView Crowd::view_with_walls(Slots slots, Walls& walls) {
  walls.x.clear();
  walls.y.clear();
  walls.clearance_m.clear();
  walls.starts.assign(1, 0);
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    state_.agents.prefetch(state_.later_decider(slots, i), offsetof(AgentState, facing));
    state_.prefetch_neighbours(slot);
    find_walls(slot, walls);
    walls.starts.push_back(static_cast<uint32_t>(walls.x.size()));
  }
  SteeringView people = view();
  people.wall_x = walls.x.data();
  people.wall_y = walls.y.data();
  people.wall_clearance_m = walls.clearance_m.data();
  people.wall_starts = walls.starts.data();
  return people;
}

void Crowd::choose(Slots slots, Walls& walls) {
  const SteeringView people = view_with_walls(slots, walls);
  model_->decide(people, slots, state_.decisions.next_x_mps.data(),
                 state_.decisions.next_y_mps.data());
  const bool limits = limits_wishes(), has_doors = doorkeeper_.has_doors();
  const float half_period_s = 0.5f * people.period_s;
  for (const uint32_t slot : slots) {
    if (limits) limit_forward(slot);
    if (has_doors) state_.agents[slot].held = state_.decisions.next_held[slot];
    if (stands_among_standing(slot))
      state_.decisions.next_x_mps[slot] = state_.decisions.next_y_mps[slot] = 0;
    const float x = state_.decisions.next_x_mps[slot], y = state_.decisions.next_y_mps[slot];
    state_.agents[slot].next_mps = {static_cast<double>(x), static_cast<double>(y)};
    // By the velocity that people have, not by the one they show: they would be pushed apart in
    // places where they never are.
    const Eigen::Vector2f old = state_.agents[slot].old_mps.cast<float>();
    state_.decisions.expected_x_m[slot] = state_.decisions.chosen_x_m[slot] =
        people.seen[slot].x_m + half_period_s * (old.x() + x);
    state_.decisions.expected_y_m[slot] = state_.decisions.chosen_y_m[slot] =
        people.seen[slot].y_m + half_period_s * (old.y() + y);
  }
}

/// A crowd that stands stays as close as it is, however much room a model of steering would give
/// it. When somebody goes by, its people make way like others.
bool Crowd::stands_among_standing(size_t slot) const {
  constexpr double kStill_mps = 0.2;
  if (!state_.stands(slot) || state_.agents[slot].old_mps.squaredNorm() > kStill_mps * kStill_mps)
    return false;
  const uint32_t* near = state_.decisions.neighbours.data() + CrowdState::kMaxNeighbours * slot;
  return std::all_of(near, near + state_.decisions.neighbour_counts[slot],
                     [this](uint32_t each) { return state_.stands(each); });
}

/// Density keeps people apart, and so do models that keep a gap.
bool Crowd::limits_wishes() const {
  return options_.steering.density_speed || !state_.traits.keeps_gap;
}

/// Before anybody chooses, as models look at what others want.
void Crowd::limit_wishes(Slots slots, Walls& walls) {
  if (!options_.steering.density_speed) {
    for (const uint32_t slot : slots) limit_to_gap(slot);
    return;
  }
  const SteeringView people = view_with_walls(slots, walls);
  for (size_t i = 0; i < slots.size(); ++i) limit_to_density(people, i, slots[i]);
}

/// Behind others of the same way people keep a gap in time, as long as nobody comes towards them.
/// Of two who are ahead of one another, the one that has the other more ahead keeps it.
void Crowd::limit_to_gap(size_t slot) {
  const std::span<Seen> seen = state_.agents.seen;
  float& wanted_x = seen[slot].wanted_x_mps;
  float& wanted_y = seen[slot].wanted_y_mps;
  const float way_x = seen[slot].way_x, way_y = seen[slot].way_y;
  const float wanted = wanted_x * way_x + wanted_y * way_y;
  const auto gap_s = static_cast<float>(tuning::kTimeGap_s);
  const uint32_t* near = state_.decisions.neighbours.data() + CrowdState::kMaxNeighbours * slot;
  const size_t count = state_.decisions.neighbour_counts[slot];
  const auto same_way = [&](uint32_t other) {
    return way_x * seen[other].way_x + way_y * seen[other].way_y;
  };
  const float reach_m = seen[slot].radius_m + state_.widest_m + wanted * gap_s;
  float speed = wanted;
  for (size_t k = 0; k < count; ++k) {
    const uint32_t other = near[k];
    const float dx = seen[other].x_m - seen[slot].x_m;
    const float dy = seen[other].y_m - seen[slot].y_m;
    const float square = dx * dx + dy * dy;
    if (square > reach_m * reach_m) break;  // they come nearest first
    const float ahead = dx * way_x + dy * way_y;
    const float aside = dx * way_y - dy * way_x;
    const float radius_m = seen[slot].radius_m + seen[other].radius_m;
    const float ahead_of_other = -(dx * seen[other].way_x + dy * seen[other].way_y);
    if (ahead <= 0 || ahead <= ahead_of_other || aside * aside >= radius_m * radius_m ||
        same_way(other) < static_cast<float>(tuning::kSameWay))
      continue;
    speed = std::min(speed, (std::sqrt(square) - radius_m) / gap_s);
  }
  if (!(speed < wanted)) return;
  for (size_t k = 0; k < count; ++k)
    if (same_way(near[k]) < -static_cast<float>(tuning::kSameWay) &&
        (seen[near[k]].x_m - seen[slot].x_m) * way_x +
                (seen[near[k]].y_m - seen[slot].y_m) * way_y >
            0)
      return;
  // As with density, the wish keeps its direction.
  speed = std::max(speed, static_cast<float>(2 * tuning::kWish_mps));
  wanted_x *= speed / wanted;
  wanted_y *= speed / wanted;
}

/// Slows the wish; never so far that it has no direction.
void Crowd::limit_to_density(const SteeringView& people, size_t i, uint32_t slot) {
  float& x = state_.agents.seen[slot].wanted_x_mps;
  float& y = state_.agents.seen[slot].wanted_y_mps;
  const float wanted = std::sqrt(x * x + y * y);
  if (!(wanted > 0)) return;
  const double free_mps = state_.agents[slot].free_speed_mps;
  const float density = density_ahead(people, i, slot, x / wanted, y / wanted);
  const float limit = std::max(static_cast<float>(2 * tuning::kWish_mps),
                               static_cast<float>(free_mps) * weidmann_share(density));
  if (wanted <= limit) return;
  x *= limit / wanted;
  y *= limit / wanted;
}

/// Making way for those behind is no reason to walk faster than the people ahead allow, and a
/// little to pass.
void Crowd::limit_forward(size_t slot) {
  const Seen& seen = state_.agents.seen[slot];
  const float way_x = seen.way_x, way_y = seen.way_y;
  if (way_x == 0 && way_y == 0) return;
  const float wanted = seen.wanted_x_mps * way_x + seen.wanted_y_mps * way_y;
  const float excess = state_.decisions.next_x_mps[slot] * way_x +
                       state_.decisions.next_y_mps[slot] * way_y -
                       static_cast<float>(tuning::kHaste) * wanted;
  if (excess <= 0) return;
  state_.decisions.next_x_mps[slot] -= excess * way_x;
  state_.decisions.next_y_mps[slot] -= excess * way_y;
}

void Crowd::find_walls(size_t slot, Walls& walls) {
  const Walkable& walkable = ways_.walkable();
  const Eigen::Vector2d& position = state_.agents[slot].position_m;
  const double radius_m = state_.agents[slot].radius_m;
  const double reach_m =
      radius_m + tuning::kHaste * state_.agents[slot].free_speed_mps * tuning::kWallHorizon_s;
  const size_t first = walls.x.size();
  double clearance_m = Walkable::kReach_m;
  const auto add = [&](const Eigen::Vector2d& normal, double distance_m) {
    clearance_m = std::min(clearance_m, distance_m);
    if (distance_m >= reach_m) return;
    const auto left_m = static_cast<float>(distance_m - radius_m);
    size_t place = walls.x.size();
    if (place - first == kMostWalls) {  // the nearest stay
      place = static_cast<size_t>(
          std::max_element(walls.clearance_m.begin() + static_cast<ptrdiff_t>(first),
                           walls.clearance_m.end()) -
          walls.clearance_m.begin());
      if (walls.clearance_m[place] <= left_m) return;
    } else {
      walls.x.push_back(0);
      walls.y.push_back(0);
      walls.clearance_m.push_back(0);
    }
    walls.x[place] = static_cast<float>(normal.x());
    walls.y[place] = static_cast<float>(normal.y());
    walls.clearance_m[place] = left_m;
  };
  const Eigen::Vector2d low = position - walkable.ground().min_m;
  const Eigen::Vector2d high = walkable.ground().max_m - position;
  add(Eigen::Vector2d::UnitX(), low.x());
  add(Eigen::Vector2d::UnitY(), low.y());
  add(-Eigen::Vector2d::UnitX(), high.x());
  add(-Eigen::Vector2d::UnitY(), high.y());
  for (const uint32_t footprint : walkable.near(position)) {
    const Walkable::Nearest wall = walkable.nearest(footprint, position);
    add(wall.normal, wall.distance_m);
  }
  state_.agents[slot].clearance_m = clearance_m;
}

double Crowd::stalled_s_of(size_t slot) const {
  return state_.step_s * static_cast<double>(state_.steps - state_.agents[slot].anchor_step);
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
