// How people decide where to go next: who is near, walls, and the steering model's choice.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "crowd/crowd.h"
#include "crowd/crowd_blocks.h"
#include "crowd/crowd_tuning.h"
#include "crowd/steering/collision_free_speed.h"

namespace throng {

void Crowd::decide() {
  begin_period();
  for (int phase = 0; phase < steps_a_period_; ++phase) decide(phase);
}

/// What is for everybody at once.
void Crowd::begin_period() {
  change_people();
  seat_people();
}

void Crowd::update_detours() {
  detours_.update(
      static_cast<uint64_t>(steps_ / steps_a_period_), grid_.order().size(),
      [this](size_t slot) {
        constexpr double kLeast_mps = 0.1;  // of those who are led
        return Detours::Walker{
            walkers_[slot].position_m,
            walkers_[slot].velocity_mps / std::max(walkers_[slot].free_speed_mps, kLeast_mps)};
      },
      workers_);
}

/// Those of a phase look around, wish, choose and are kept out of each other.
void Crowd::decide(int phase) {
  phase_ = static_cast<size_t>(phase);
  // Not in the frame that begins a period: that takes the most time as it is.
  if (phase == steps_a_period_ / 2) update_detours();
  if (parties_.any()) {
    for_deciders([this](Slots slots, size_t, int) { look_around(slots); });
    parties_.gather(static_cast<uint32_t>(phase), static_cast<uint32_t>(steps_a_period_), journeys_,
                    positions_m_, options_.step_s * static_cast<double>(steps_), workers_);
  }
  counters_.longest_stall_s = largest([this](Slots slots, size_t) { return wish(slots); });
  counters_.queuing = 0;
  for (size_t slot = 0; slot < grid_.order().size(); ++slot)
    counters_.queuing += walkers_.queuing[slot];
  if (limits_wishes())
    for_deciders([this](Slots slots, size_t, int worker) {
      limit_wishes(slots, walls_[static_cast<size_t>(worker)]);
    });
  for_deciders([this](Slots slots, size_t, int worker) {
    choose(slots, walls_[static_cast<size_t>(worker)]);
  });
  relax_discs();
  ++counters_.rounds;
  counters_.decisions += deciders().size();
}

/// Goals are reached, and people come and go, before anybody looks around.
void Crowd::change_people() {
  const double now_s = options_.step_s * static_cast<double>(steps_);
  // By id, as what journeys know is.
  for_people(workers_, size(), [&](size_t begin, size_t end, int) {
    for (size_t id = begin; id < end; ++id) {
      const uint32_t slot = slot_of_[id];
      const auto held_up =
          slot == kNowhere ? HeldUp::kNot : static_cast<HeldUp>(walkers_.held_up[slot]);
      journeys_.follow(static_cast<uint32_t>(id), positions_m_[id], now_s, held_up);
    }
  });
  if (!ways_.occasions().empty()) {
    occasions_.watch(journeys_, now_s);
    for (size_t group = 0; group < ways_.groups(); ++group)
      if (const std::optional<uint32_t> after = ways_.after(group))
        journeys_.let_go(group, occasions_.time_s(*after));
  }
  if (doorkeeper_.has_doors())
    doorkeeper_.follow(occasions_, traffic_.present(), positions_m_, now_s);
  if (traffic_.is_open()) {
    traffic_.release(journeys_);
    traffic_.admit(now_s, journeys_, positions_m_);
  }
  if (exits_.has_any())
    exits_.choose(static_cast<uint64_t>(steps_ / steps_a_period_), positions_m_, grid_.order(),
                  walkers_.queuing, journeys_, workers_);
  if (queues_.any()) queues_.follow(traffic_.present(), positions_m_, journeys_, workers_);
  for (const uint32_t id : traffic_.entered()) {
    const Eigen::Vector2d way = journeys_.direction(id, positions_m_[id]);
    if (way.squaredNorm() > 0) headings_[id] = way;
  }
}

void Crowd::look_around(Slots slots) {
  // The fields are too large for the caches: fetched now, they are there after the search.
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    const uint32_t later = later_decider(slots, i);
    walkers_.prefetch(later, sizeof(AgentState));
    journeys_.prefetch(grid_.order()[later]);
    walkers_[slot].own_side_m = own_side_m(slot);
    journeys_.prefetch(grid_.order()[slot], walkers_[slot].position_m, own_side(slot));
  }
  grid_.nearest(slots, static_cast<float>(tuning::kReach_m), slots_.neighbours.data(),
                slots_.neighbour_counts.data());
  if (!parties_.any()) return;
  for (const uint32_t slot : slots) {
    const uint32_t id = grid_.order()[slot];
    if (!parties_.has(id)) continue;
    parties_.see(id, strangers_per_m2(slot));
    overlook_companions(slot);
  }
}

/// Companions who walk beside each other do not avoid each other: each knows where the other goes.
/// Who comes too near is seen again.
void Crowd::overlook_companions(size_t slot) {
  const auto walks_beside = [&](uint32_t other) {
    if (!parties_.are_companions(grid_.order()[slot], grid_.order()[other])) return false;
    const Eigen::Vector2d offset = walkers_[other].position_m - walkers_[slot].position_m;
    const Eigen::Vector2d both_mps = walkers_[slot].velocity_mps + walkers_[other].velocity_mps;
    const double along = std::abs(offset.dot(both_mps)), square_m2 = offset.squaredNorm();
    const double gap_m = walkers_[slot].radius_m + walkers_[other].radius_m + tuning::kBesideGap_m;
    return both_mps.squaredNorm() > tuning::kBeside_mps * tuning::kBeside_mps &&
           square_m2 > gap_m * gap_m && 2 * along * along < square_m2 * both_mps.squaredNorm();
  };
  uint32_t* near = slots_.neighbours.data() + kMaxNeighbours * slot;
  uint8_t& count = slots_.neighbour_counts[slot];
  count = static_cast<uint8_t>(std::remove_if(near, near + count, walks_beside) - near);
}

/// Within two metres beside the way; those farther off, ahead and behind count less.
double Crowd::strangers_per_m2(size_t slot) const {
  constexpr double kReach_m = 2;
  const Eigen::Vector2d& intent = walkers_[slot].intent_mps;
  const double speed = intent.norm();
  double sum = 0;
  for (size_t k = 0; k < slots_.neighbour_counts[slot]; ++k) {
    const uint32_t other = slots_.neighbours[kMaxNeighbours * slot + k];
    if (parties_.are_companions(grid_.order()[slot], grid_.order()[other])) continue;
    const Eigen::Vector2d offset = walkers_[other].position_m - walkers_[slot].position_m;
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
    AgentState& w = walkers_[slot];
    Seen& seen = walkers_.seen[slot];
    w.old_mps = w.velocity_mps;
    longest_s = std::max(longest_s, watch_progress(slot));
    wish_for(slot, wanted_mps(slot).cast<float>());
    const double stalled_s = stalled_s_of(slot);
    seen.urge = static_cast<float>(
        tuning::share_between(tuning::kUrgeFrom_s, tuning::kUrgeTo_s, stalled_s));
    const auto eager = static_cast<float>(
        tuning::share_between(tuning::kEagerFrom_s, tuning::kEagerTo_s, stalled_s));
    seen.eagerness =
        std::max(eager, seen.eagerness - static_cast<float>(period_s_ / tuning::kEagerFor_s));
    stretch(slot);
    show(slot);
    find_facing(slot);
    w.look_to_rad = look_to_rad(slot);
    seen.max_speed_mps = static_cast<float>(tuning::kHaste * w.free_speed_mps);
    seen.horizon_s = static_cast<float>(stalled_s > tuning::kStuck_s ? tuning::kStuckHorizon_s
                                                                     : tuning::kHorizon_s);
  }
  return longest_s;
}

void Crowd::wish_for(size_t slot, const Eigen::Vector2f& wanted_mps) {
  Seen& seen = walkers_.seen[slot];
  seen.wanted_x_mps = wanted_mps.x();
  seen.wanted_y_mps = wanted_mps.y();
  const float length = std::sqrt(wanted_mps.x() * wanted_mps.x() + wanted_mps.y() * wanted_mps.y());
  const bool walks = length >= static_cast<float>(tuning::kWish_mps);
  seen.way_x = walks ? wanted_mps.x() / length : 0.0f;
  seen.way_y = walks ? wanted_mps.y() / length : 0.0f;
}

SteeringView Crowd::view() const {
  SteeringView view;
  view.seen = walkers_.seen.data();
  view.neighbours = slots_.neighbours.data();
  view.neighbour_counts = slots_.neighbour_counts.data();
  view.period_s = static_cast<float>(period_s_);
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
    walkers_.prefetch(later_decider(slots, i), offsetof(AgentState, facing));
    prefetch_neighbours(slot);
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
  model_->decide(people, slots, slots_.next_x_mps.data(), slots_.next_y_mps.data());
  const bool limits = limits_wishes(), has_doors = doorkeeper_.has_doors();
  const float half_period_s = 0.5f * people.period_s;
  for (const uint32_t slot : slots) {
    if (limits) limit_forward(slot);
    if (has_doors) walkers_[slot].held = slots_.next_held[slot];
    if (stands_among_standing(slot)) slots_.next_x_mps[slot] = slots_.next_y_mps[slot] = 0;
    const float x = slots_.next_x_mps[slot], y = slots_.next_y_mps[slot];
    walkers_[slot].next_mps = {static_cast<double>(x), static_cast<double>(y)};
    // By the velocity that people have, not by the one they show: they would be pushed apart in
    // places where they never are.
    const Eigen::Vector2f old = walkers_[slot].old_mps.cast<float>();
    slots_.expected_x_m[slot] = slots_.chosen_x_m[slot] =
        people.seen[slot].x_m + half_period_s * (old.x() + x);
    slots_.expected_y_m[slot] = slots_.chosen_y_m[slot] =
        people.seen[slot].y_m + half_period_s * (old.y() + y);
  }
}

/// A crowd that stands stays as close as it is, however much room a model of steering would give
/// it. When somebody goes by, its people make way like others.
bool Crowd::stands_among_standing(size_t slot) const {
  constexpr double kStill_mps = 0.2;
  if (!stands(slot) || walkers_[slot].old_mps.squaredNorm() > kStill_mps * kStill_mps) return false;
  const uint32_t* near = slots_.neighbours.data() + kMaxNeighbours * slot;
  return std::all_of(near, near + slots_.neighbour_counts[slot],
                     [this](uint32_t each) { return stands(each); });
}

/// Density keeps people apart, and so do models that keep a gap.
bool Crowd::limits_wishes() const { return options_.steering.density_speed || !traits_.keeps_gap; }

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
  const std::span<Seen> seen = walkers_.seen;
  float& wanted_x = seen[slot].wanted_x_mps;
  float& wanted_y = seen[slot].wanted_y_mps;
  const float way_x = seen[slot].way_x, way_y = seen[slot].way_y;
  const float wanted = wanted_x * way_x + wanted_y * way_y;
  const auto gap_s = static_cast<float>(tuning::kTimeGap_s);
  const uint32_t* near = slots_.neighbours.data() + kMaxNeighbours * slot;
  const size_t count = slots_.neighbour_counts[slot];
  const auto same_way = [&](uint32_t other) {
    return way_x * seen[other].way_x + way_y * seen[other].way_y;
  };
  const float reach_m = seen[slot].radius_m + widest_m_ + wanted * gap_s;
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
  float& x = walkers_.seen[slot].wanted_x_mps;
  float& y = walkers_.seen[slot].wanted_y_mps;
  const float wanted = std::sqrt(x * x + y * y);
  if (!(wanted > 0)) return;
  const double free_mps = walkers_[slot].free_speed_mps;
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
  const Seen& seen = walkers_.seen[slot];
  const float way_x = seen.way_x, way_y = seen.way_y;
  if (way_x == 0 && way_y == 0) return;
  const float wanted = seen.wanted_x_mps * way_x + seen.wanted_y_mps * way_y;
  const float excess = slots_.next_x_mps[slot] * way_x + slots_.next_y_mps[slot] * way_y -
                       static_cast<float>(tuning::kHaste) * wanted;
  if (excess <= 0) return;
  slots_.next_x_mps[slot] -= excess * way_x;
  slots_.next_y_mps[slot] -= excess * way_y;
}

void Crowd::find_walls(size_t slot, Walls& walls) {
  const Walkable& walkable = ways_.walkable();
  const Eigen::Vector2d& position = walkers_[slot].position_m;
  const double radius_m = walkers_[slot].radius_m;
  const double reach_m =
      radius_m + tuning::kHaste * walkers_[slot].free_speed_mps * tuning::kWallHorizon_s;
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
  walkers_[slot].clearance_m = clearance_m;
}

double Crowd::stalled_s_of(size_t slot) const {
  return options_.step_s * static_cast<double>(steps_ - walkers_[slot].anchor_step);
}

/// How long somebody has been stuck, the time of queuing taken off.
double Crowd::watch_progress(size_t slot) {
  AgentState& w = walkers_[slot];
  const uint32_t id = grid_.order()[slot];
  const bool goes = journeys_.doing(id) == Doing::kWalking || queues_.is_awaited(id);
  const bool stands = !goes || w.held != 0 || parties_.waits(id);
  if (stands || (w.position_m - w.anchor_m).squaredNorm() >= kStall_m * kStall_m) {
    w.anchor_m = w.position_m;
    w.anchor_step = steps_;
    w.queued_steps = 0;
  }
  walkers_.queuing[slot] = is_queuing(slot);
  if (walkers_.queuing[slot] != 0) w.queued_steps += steps_a_period_;
  const double stuck_s =
      std::max(0.0, options_.step_s * static_cast<double>(steps_ - w.anchor_step - w.queued_steps));
  walkers_.held_up[slot] = static_cast<uint8_t>(held_up(slot, stuck_s));
  return stuck_s;
}

HeldUp Crowd::held_up(size_t slot, double stuck_s) const {
  const uint32_t id = grid_.order()[slot];
  if (journeys_.walks_to_stay(id) && is_slow(slot)) {
    const Stop& stop = journeys_.stop(id);
    const bool is_behind = is_behind_any(slot, [&](uint32_t other) {
      const Stop& its = journeys_.stop(grid_.order()[other]);
      return journeys_.is_staying(grid_.order()[other]) && its.field == stop.field &&
             (its.is_narrow() || !its.contains(walkers_[other].position_m));
    });
    if (is_behind) return HeldUp::kBehindStaying;
  }
  return stuck_s >= tuning::kPatience_s ? HeldUp::kStuck : HeldUp::kNot;
}

bool Crowd::is_slow(size_t slot) const {
  const double slow_mps = tuning::kQueueSpeed * walkers_[slot].free_speed_mps;
  return walkers_[slot].velocity_mps.squaredNorm() <= slow_mps * slow_mps;
}

/// Returns whether an agent for which `holds_up(slot)` is true is ahead of another within 60
/// degrees, at a gap of tuning::kQueueGap_m at most.
template <typename HoldsUp>
bool Crowd::is_behind_any(size_t slot, const HoldsUp& holds_up) const {
  const Eigen::Vector2d& position = walkers_[slot].position_m;
  std::optional<Eigen::Vector2d> way;  // found when an agent near by holds up
  for (size_t k = 0; k < slots_.neighbour_counts[slot]; ++k) {
    const uint32_t other = slots_.neighbours[kMaxNeighbours * slot + k];
    const Eigen::Vector2d offset = walkers_[other].position_m - position;
    const double reach_m = walkers_[slot].radius_m + walkers_[other].radius_m + tuning::kQueueGap_m;
    if (offset.squaredNorm() > reach_m * reach_m) return false;
    if (!holds_up(other)) continue;
    if (!way) way = journeys_.direction(grid_.order()[slot], position);
    if (way->dot(offset) > 0.5 * offset.norm()) return true;
  }
  return false;
}

bool Crowd::is_queuing(size_t slot) const {
  const uint32_t id = grid_.order()[slot];
  if (journeys_.doing(id) == Doing::kQueuing) return true;
  if (journeys_.doing(id) != Doing::kWalking || !is_slow(slot)) return false;
  const FlowField* field = &journeys_.field(id);
  return is_behind_any(slot, [&](uint32_t other) {
    const uint32_t other_id = grid_.order()[other];
    return journeys_.doing(other_id) == Doing::kWalking && &journeys_.field(other_id) == field;
  });
}

}  // namespace throng
