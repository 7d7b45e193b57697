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
      limits_(by_density || !state.traits.has_time_gap),
      walls_(static_cast<size_t>(state.workers.threads())) {
  for (Walls& walls : walls_) {
    walls.x.reserve(kAgentsPerBlock * kMaxWalls);
    walls.y.reserve(kAgentsPerBlock * kMaxWalls);
    walls.clearance_m.reserve(kAgentsPerBlock * kMaxWalls);
    walls.starts.reserve(kAgentsPerBlock + 1);
  }
}

void Avoidance::prepare(size_t slot) {
  NeighbourState& published = state_.agents.published[slot];
  published.max_speed_mps =
      static_cast<float>(tuning::kMaxSpeedFactor * state_.agents[slot].desired_speed_mps);
  published.horizon_s = static_cast<float>(
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

/// A separate pass, because models read the preferred velocities of neighbours.
void Avoidance::limit(SteeringState::Slots slots, Walls& walls) {
  if (!by_density_) {
    for (const uint32_t slot : slots) limit_to_gap(slot);
    return;
  }
  const SteeringView people = view_with_walls(slots, walls);
  for (size_t i = 0; i < slots.size(); ++i) limit_to_density(people, i, slots[i]);
}

/// Agents of the same direction keep a time gap, unless oncoming agents are in reach. Of two such
/// agents, the one that has the other more directly ahead keeps the gap.
void Avoidance::limit_to_gap(size_t slot) {
  const std::span<NeighbourState> published = state_.agents.published;
  float& preferred_x = published[slot].preferred_x_mps;
  float& preferred_y = published[slot].preferred_y_mps;
  const float direction_x = published[slot].direction_x, direction_y = published[slot].direction_y;
  const float preferred = preferred_x * direction_x + preferred_y * direction_y;
  const auto gap_s = static_cast<float>(tuning::kTimeGap_s);
  const SteeringState::Slots near = state_.neighbours(slot);
  const auto direction_cosine = [&](uint32_t other) {
    return direction_x * published[other].direction_x + direction_y * published[other].direction_y;
  };
  const float reach_m = published[slot].radius_m + state_.max_radius_m + preferred * gap_s;
  float speed = preferred;
  for (const uint32_t other : near) {
    const float dx = published[other].x_m - published[slot].x_m;
    const float dy = published[other].y_m - published[slot].y_m;
    const float square = dx * dx + dy * dy;
    if (square > reach_m * reach_m) break;  // neighbours are sorted by distance
    const float ahead = dx * direction_x + dy * direction_y;
    const float aside = dx * direction_y - dy * direction_x;
    const float radius_m = published[slot].radius_m + published[other].radius_m;
    const float ahead_of_other =
        -(dx * published[other].direction_x + dy * published[other].direction_y);
    if (ahead <= 0 || ahead <= ahead_of_other || aside * aside >= radius_m * radius_m ||
        direction_cosine(other) < static_cast<float>(tuning::kSameDirection))
      continue;
    speed = std::min(speed, (std::sqrt(square) - radius_m) / gap_s);
  }
  if (!(speed < preferred)) return;
  for (const uint32_t other : near)
    if (direction_cosine(other) < -static_cast<float>(tuning::kSameDirection) &&
        (published[other].x_m - published[slot].x_m) * direction_x +
                (published[other].y_m - published[slot].y_m) * direction_y >
            0)
      return;
  speed = std::max(speed, static_cast<float>(2 * tuning::kMinPreferred_mps));
  preferred_x *= speed / preferred;
  preferred_y *= speed / preferred;
}

/// Limits the preferred speed, but keeps enough of it for a direction.
void Avoidance::limit_to_density(const SteeringView& people, size_t i, uint32_t slot) {
  float& x = state_.agents.published[slot].preferred_x_mps;
  float& y = state_.agents.published[slot].preferred_y_mps;
  const float preferred = std::sqrt(x * x + y * y);
  if (!(preferred > 0)) return;
  const double desired_mps = state_.agents[slot].desired_speed_mps;
  const float density = density_ahead(people, i, slot, x / preferred, y / preferred);
  const float limit = std::max(static_cast<float>(2 * tuning::kMinPreferred_mps),
                               static_cast<float>(desired_mps) * weidmann_share(density));
  if (preferred <= limit) return;
  x *= limit / preferred;
  y *= limit / preferred;
}

void Avoidance::choose(SteeringState::Slots slots, Walls& walls) {
  const SteeringView people = view_with_walls(slots, walls);
  model_.decide(people, slots, decisions_.next_x_mps.data(), decisions_.next_y_mps.data());
  const float half_period_s = 0.5f * people.period_s;
  for (const uint32_t slot : slots) {
    if (limits_) limit_forward(slot);
    if (stands_in_standing_crowd(slot))
      decisions_.next_x_mps[slot] = decisions_.next_y_mps[slot] = 0;
    const float x = decisions_.next_x_mps[slot], y = decisions_.next_y_mps[slot];
    state_.agents[slot].next_mps = {static_cast<double>(x), static_cast<double>(y)};
    // Starts from the actual velocity, not the published one: otherwise relaxation would act at
    // places that agents never reach.
    const Eigen::Vector2f old = state_.agents[slot].old_mps.cast<float>();
    decisions_.expected_x_m[slot] = decisions_.chosen_x_m[slot] =
        people.published[slot].x_m + half_period_s * (old.x() + x);
    decisions_.expected_y_m[slot] = decisions_.chosen_y_m[slot] =
        people.published[slot].y_m + half_period_s * (old.y() + y);
  }
}

/// Agents behind may only speed an agent up to what those ahead allow, plus a little for passing.
void Avoidance::limit_forward(size_t slot) {
  const NeighbourState& published = state_.agents.published[slot];
  const float direction_x = published.direction_x, direction_y = published.direction_y;
  if (direction_x == 0 && direction_y == 0) return;
  const float preferred =
      published.preferred_x_mps * direction_x + published.preferred_y_mps * direction_y;
  const float excess = decisions_.next_x_mps[slot] * direction_x +
                       decisions_.next_y_mps[slot] * direction_y -
                       static_cast<float>(tuning::kMaxSpeedFactor) * preferred;
  if (excess <= 0) return;
  decisions_.next_x_mps[slot] -= excess * direction_x;
  decisions_.next_y_mps[slot] -= excess * direction_y;
}

/// A standing crowd keeps its spacing even if the steering model asks for more. Near moving agents,
/// its members make room as usual.
bool Avoidance::stands_in_standing_crowd(size_t slot) const {
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
  people.published = state_.agents.published.data();
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
  const double reach_m = radius_m + tuning::kMaxSpeedFactor *
                                        state_.agents[slot].desired_speed_mps *
                                        tuning::kWallHorizon_s;
  const size_t first = walls.x.size();
  double clearance_m = Walkable::kReach_m;
  const auto add = [&](const Eigen::Vector2d& normal, double distance_m) {
    clearance_m = std::min(clearance_m, distance_m);
    if (distance_m >= reach_m) return;
    const auto left_m = static_cast<float>(distance_m - radius_m);
    size_t place = walls.x.size();
    if (place - first == kMaxWalls) {  // the nearest stay
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
  walls.pieces.clear();
  for (const uint32_t footprint : walkable_.nearby_footprints(position)) {
    const uint32_t surface = walkable_.surface_of(footprint);
    if (surface != 0 && walkable_.is_beyond(footprint, position, Walkable::kReach_m)) continue;
    const Walkable::Nearest wall = walkable_.nearest(footprint, position);
    if (surface == 0)
      add(wall.normal, wall.distance_m);
    else if (wall.distance_m < Walkable::kReach_m)
      walls.pieces.push_back({wall.distance_m, footprint, surface, wall.normal,
                              position - wall.distance_m * wall.normal});
  }
  keep_foremost(walls.pieces);
  for (const SurfacePoint& piece : walls.pieces) add(piece.normal, piece.distance_m);
  state_.agents[slot].clearance_m = clearance_m;
}

/// A long or curved wall has many pieces. One counts only if its nearest point lies before the
/// planes of all nearer ones. Without this rule, a wall in ten pieces would push ten times.
void Avoidance::keep_foremost(std::vector<SurfacePoint>& pieces) {
  constexpr double kBefore_m = 0.02;
  std::sort(pieces.begin(), pieces.end(), [](const SurfacePoint& a, const SurfacePoint& b) {
    return std::tie(a.distance_m, a.footprint) < std::tie(b.distance_m, b.footprint);
  });
  size_t kept = 0;
  for (size_t i = 0; i < pieces.size() && kept < kMaxWalls; ++i) {
    const SurfacePoint piece = pieces[i];
    const bool is_behind = std::any_of(
        pieces.begin(), pieces.begin() + static_cast<ptrdiff_t>(kept), [&](const auto& nearer) {
          return nearer.surface == piece.surface &&
                 nearer.normal.dot(piece.point_m - nearer.point_m) <= kBefore_m;
        });
    if (!is_behind) pieces[kept++] = piece;
  }
  pieces.resize(kept, pieces.empty() ? SurfacePoint{} : pieces.front());
}

}  // namespace throng
