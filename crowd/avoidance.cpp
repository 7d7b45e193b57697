#include "crowd/avoidance.h"

#include <algorithm>
#include <cmath>

#include "crowd/crowd_tuning.h"
#include "crowd/steering/collision_free_speed.h"

namespace throng {

Avoidance::Avoidance(SteeringState& state, const SteeringModel& model, const Walkable& walkable,
                     bool by_density)
    : state_(state),
      decisions_(state.decisions),
      model_(model),
      walkable_(walkable),
      by_density_(by_density),
      limits_(by_density || !state.traits.keeps_gap),
      walls_(static_cast<size_t>(state.workers.threads())) {
  for (Walls& walls : walls_) {
    walls.x.reserve(kPeopleABlock * kMostWalls);
    walls.y.reserve(kPeopleABlock * kMostWalls);
    walls.clearance_m.reserve(kPeopleABlock * kMostWalls);
    walls.starts.reserve(kPeopleABlock + 1);
  }
}

void Avoidance::prepare(size_t slot) {
  Seen& seen = state_.agents.seen[slot];
  seen.max_speed_mps = static_cast<float>(tuning::kHaste * state_.agents[slot].free_speed_mps);
  seen.horizon_s = static_cast<float>(
      state_.stalled_s(slot) > tuning::kStuck_s ? tuning::kStuckHorizon_s : tuning::kHorizon_s);
}

void Avoidance::choose() {
  if (limits_)
    state_.for_deciders([this](SteeringState::Slots slots, size_t, int worker) {
      limit(slots, walls_[static_cast<size_t>(worker)]);
    });
  state_.for_deciders([this](SteeringState::Slots slots, size_t, int worker) {
    choose(slots, walls_[static_cast<size_t>(worker)]);
  });
}

/// Before anybody chooses, as models look at what others want.
void Avoidance::limit(SteeringState::Slots slots, Walls& walls) {
  if (!by_density_) {
    for (const uint32_t slot : slots) limit_to_gap(slot);
    return;
  }
  const SteeringView people = view_with_walls(slots, walls);
  for (size_t i = 0; i < slots.size(); ++i) limit_to_density(people, i, slots[i]);
}

/// Behind others of the same way people keep a gap in time, as long as nobody comes towards them.
/// Of two who are ahead of one another, the one that has the other more ahead keeps it.
void Avoidance::limit_to_gap(size_t slot) {
  const std::span<Seen> seen = state_.agents.seen;
  float& wanted_x = seen[slot].wanted_x_mps;
  float& wanted_y = seen[slot].wanted_y_mps;
  const float way_x = seen[slot].way_x, way_y = seen[slot].way_y;
  const float wanted = wanted_x * way_x + wanted_y * way_y;
  const auto gap_s = static_cast<float>(tuning::kTimeGap_s);
  const SteeringState::Slots near = state_.neighbours(slot);
  const auto same_way = [&](uint32_t other) {
    return way_x * seen[other].way_x + way_y * seen[other].way_y;
  };
  const float reach_m = seen[slot].radius_m + state_.widest_m + wanted * gap_s;
  float speed = wanted;
  for (const uint32_t other : near) {
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
  for (const uint32_t other : near)
    if (same_way(other) < -static_cast<float>(tuning::kSameWay) &&
        (seen[other].x_m - seen[slot].x_m) * way_x + (seen[other].y_m - seen[slot].y_m) * way_y > 0)
      return;
  // As with density, the wish keeps its direction.
  speed = std::max(speed, static_cast<float>(2 * tuning::kWish_mps));
  wanted_x *= speed / wanted;
  wanted_y *= speed / wanted;
}

/// Slows the wish; never so far that it has no direction.
void Avoidance::limit_to_density(const SteeringView& people, size_t i, uint32_t slot) {
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

void Avoidance::choose(SteeringState::Slots slots, Walls& walls) {
  const SteeringView people = view_with_walls(slots, walls);
  model_.decide(people, slots, decisions_.next_x_mps.data(), decisions_.next_y_mps.data());
  const float half_period_s = 0.5f * people.period_s;
  for (const uint32_t slot : slots) {
    if (limits_) limit_forward(slot);
    if (stands_among_standing(slot)) decisions_.next_x_mps[slot] = decisions_.next_y_mps[slot] = 0;
    const float x = decisions_.next_x_mps[slot], y = decisions_.next_y_mps[slot];
    state_.agents[slot].next_mps = {static_cast<double>(x), static_cast<double>(y)};
    // By the velocity that people have, not by the one they show: they would be pushed apart in
    // places where they never are.
    const Eigen::Vector2f old = state_.agents[slot].old_mps.cast<float>();
    decisions_.expected_x_m[slot] = decisions_.chosen_x_m[slot] =
        people.seen[slot].x_m + half_period_s * (old.x() + x);
    decisions_.expected_y_m[slot] = decisions_.chosen_y_m[slot] =
        people.seen[slot].y_m + half_period_s * (old.y() + y);
  }
}

/// Making way for those behind is no reason to walk faster than the people ahead allow, and a
/// little to pass.
void Avoidance::limit_forward(size_t slot) {
  const Seen& seen = state_.agents.seen[slot];
  const float way_x = seen.way_x, way_y = seen.way_y;
  if (way_x == 0 && way_y == 0) return;
  const float wanted = seen.wanted_x_mps * way_x + seen.wanted_y_mps * way_y;
  const float excess = decisions_.next_x_mps[slot] * way_x + decisions_.next_y_mps[slot] * way_y -
                       static_cast<float>(tuning::kHaste) * wanted;
  if (excess <= 0) return;
  decisions_.next_x_mps[slot] -= excess * way_x;
  decisions_.next_y_mps[slot] -= excess * way_y;
}

/// A crowd that stands stays as close as it is, however much room a model of steering would give
/// it. When somebody goes by, its people make way like others.
bool Avoidance::stands_among_standing(size_t slot) const {
  constexpr double kStill_mps = 0.2;
  if (!state_.stands(slot) || state_.agents[slot].old_mps.squaredNorm() > kStill_mps * kStill_mps)
    return false;
  const SteeringState::Slots near = state_.neighbours(slot);
  return std::all_of(near.begin(), near.end(),
                     [this](uint32_t each) { return state_.stands(each); });
}

SteeringView Avoidance::view_with_walls(SteeringState::Slots slots, Walls& walls) {
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
  SteeringView people;
  people.seen = state_.agents.seen.data();
  people.neighbours = decisions_.neighbours.data();
  people.neighbour_counts = decisions_.neighbour_counts.data();
  people.period_s = static_cast<float>(state_.period_s);
  people.wall_horizon_s = static_cast<float>(tuning::kWallHorizon_s);
  people.wall_x = walls.x.data();
  people.wall_y = walls.y.data();
  people.wall_clearance_m = walls.clearance_m.data();
  people.wall_starts = walls.starts.data();
  return people;
}

void Avoidance::find_walls(size_t slot, Walls& walls) {
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
  const Eigen::Vector2d low = position - walkable_.ground().min_m;
  const Eigen::Vector2d high = walkable_.ground().max_m - position;
  add(Eigen::Vector2d::UnitX(), low.x());
  add(Eigen::Vector2d::UnitY(), low.y());
  add(-Eigen::Vector2d::UnitX(), high.x());
  add(-Eigen::Vector2d::UnitY(), high.y());
  for (const uint32_t footprint : walkable_.near(position)) {
    const Walkable::Nearest wall = walkable_.nearest(footprint, position);
    add(wall.normal, wall.distance_m);
  }
  state_.agents[slot].clearance_m = clearance_m;
}

}  // namespace throng
