// How people decide where to go next: goals, walls, others, and what is left of overlaps.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "scenes/crowd.h"
#include "scenes/crowd_blocks.h"
#include "scenes/crowd_tuning.h"

namespace throng {

/// Walls first, they are hard; then people.
struct Crowd::Plan {
  static constexpr size_t kMaxWalls = 24;
  std::array<HalfPlane, kMaxWalls + kMaxNeighbours> planes;
  size_t walls = 0;
  size_t count = 0;

  /// Keeps the tightest walls if there are more than room.
  void add_wall(const HalfPlane& wall) {
    if (walls < kMaxWalls) {
      planes[walls++] = wall;
      return;
    }
    const auto loosest =
        std::min_element(planes.begin(), planes.begin() + kMaxWalls,
                         [](const auto& a, const auto& b) { return a.offset_mps < b.offset_mps; });
    if (loosest->offset_mps < wall.offset_mps) *loosest = wall;
  }
};

void Crowd::decide() {
  change_people();
  grid_.rebuild(positions_m_, traffic_.present());
  old_velocities_mps_.swap(next_velocities_mps_);
  for_people([this](uint32_t id) { decide_for(id); });
  relax_discs();
  measure();
  counters_.decisions += grid_.order().size();
}

void Crowd::decide_for(uint32_t id) {
  const std::span<Neighbour> near(neighbours_.data() + id * kMaxNeighbours, kMaxNeighbours);
  neighbour_counts_[id] = static_cast<uint32_t>(grid_.nearest(id, tuning::kReach_m, near));
  Plan plan;
  add_walls(id, plan);
  plan.count = plan.walls;
  add_people(id, plan);
  next_velocities_mps_[id] =
      choose_velocity({plan.planes.data(), plan.count}, static_cast<int>(plan.walls),
                      wanted_mps(id), tuning::kHaste * free_speeds_mps_[id]);
  expected_m_[id] =
      positions_m_[id] + 0.5 * period_s_ * (old_velocities_mps_[id] + next_velocities_mps_[id]);
}

/// Goals are reached, and people come and go, before anybody looks around.
void Crowd::change_people() {
  const double now_s = options_.step_s * static_cast<double>(steps_);
  for_people([&](uint32_t id) { journeys_.follow(id, positions_m_[id], now_s); });
  if (!traffic_.is_open()) return;
  traffic_.release(journeys_);
  traffic_.admit(now_s, journeys_, positions_m_);
  for (const uint32_t id : traffic_.entered()) {
    const Eigen::Vector2d way = journeys_.direction(id, positions_m_[id]);
    start_walking(id, way.squaredNorm() > 0 ? way : headings_[id]);
  }
}

Eigen::Vector2d Crowd::wanted_mps(uint32_t id) {
  Eigen::Vector2d direction = journeys_.direction(id, positions_m_[id]);
  const double stalled_s = stalled_s_of(id);
  if (stalled_s > tuning::kStuck_s) {
    const auto second = static_cast<uint64_t>(std::floor(stalled_s));
    const RandomKey key{options_.seed, id, static_cast<uint64_t>(anchor_steps_[id]) + second,
                        Purpose::kSymmetryBreaking};
    const double side = random_uniform(key, -tuning::kSidestep, tuning::kSidestep, 2);
    direction += side * Eigen::Vector2d(-direction.y(), direction.x());
    if (direction.squaredNorm() > 0) direction.normalize();
  }
  const double share = period_s_ / (tuning::kRelaxation_s + period_s_);
  intents_mps_[id] += share * (free_speeds_mps_[id] * direction - intents_mps_[id]);
  const RandomKey key{options_.seed, id, static_cast<uint64_t>(steps_), Purpose::kSymmetryBreaking};
  const double size = tuning::kPerturbation_mps;
  return intents_mps_[id] +
         Eigen::Vector2d(random_uniform(key, -size, size, 0), random_uniform(key, -size, size, 1));
}

void Crowd::add_walls(uint32_t id, Plan& plan) {
  const Walkable& walkable = ways_.walkable();
  const Eigen::Vector2d& position = positions_m_[id];
  const double radius_m = radii_m_[id];
  const double reach_m = radius_m + tuning::kHaste * free_speeds_mps_[id] * tuning::kWallHorizon_s;
  double clearance_m = Walkable::kReach_m;
  const auto add = [&](const Eigen::Vector2d& normal, double distance_m) {
    clearance_m = std::min(clearance_m, distance_m);
    if (distance_m < reach_m)
      plan.add_wall(keep_off(normal, distance_m - radius_m, tuning::kWallHorizon_s));
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
  clearances_m_[id] = clearance_m;
}

void Crowd::add_people(uint32_t id, Plan& plan) const {
  const bool is_stuck = stalled_s_of(id) > tuning::kStuck_s;
  const double horizon_s = is_stuck ? tuning::kStuckHorizon_s : tuning::kHorizon_s;
  for (uint32_t k = 0; k < neighbour_counts_[id]; ++k) {
    const uint32_t other = neighbours_[id * kMaxNeighbours + k].id;
    Encounter encounter;
    encounter.offset_m = positions_m_[other] - positions_m_[id];
    // Two in one place part along x, each to its own side.
    if (encounter.offset_m.squaredNorm() == 0) encounter.offset_m.x() = id < other ? 1e-6 : -1e-6;
    encounter.own_velocity_mps = old_velocities_mps_[id];
    encounter.other_velocity_mps = old_velocities_mps_[other];
    encounter.radius_m = radii_m_[id] + radii_m_[other];
    encounter.horizon_s = horizon_s;
    encounter.step_s = period_s_;
    plan.planes[plan.count++] = avoid(encounter);
  }
}

void Crowd::relax_discs() {
  counters_.sweeps = 0;
  double deepest_m = tuning::kSlop_m;
  while (deepest_m >= tuning::kSlop_m && counters_.sweeps < tuning::kSweeps) {
    deepest_m = largest([this](uint32_t id) { return relax_disc(id); });
    expected_m_.swap(relaxed_m_);
    ++counters_.sweeps;
  }
  // The correction is spread over the period, so that nobody jumps.
  for_people([this](uint32_t id) {
    const Eigen::Vector2d way = expected_m_[id] - positions_m_[id];
    const Eigen::Vector2d mean = 0.5 * (old_velocities_mps_[id] + next_velocities_mps_[id]);
    const Eigen::Vector2d drift = way / period_s_ - mean;
    const double length = drift.norm();
    drifts_mps_[id] =
        length > tuning::kMaxDrift_mps ? drift * (tuning::kMaxDrift_mps / length) : drift;
  });
}

double Crowd::relax_disc(uint32_t id) {
  const Eigen::Vector2d position = expected_m_[id];
  Eigen::Vector2d push = Eigen::Vector2d::Zero();
  double deepest_m = 0;
  for (uint32_t k = 0; k < neighbour_counts_[id]; ++k) {
    const uint32_t other = neighbours_[id * kMaxNeighbours + k].id;
    const Eigen::Vector2d offset = position - expected_m_[other];
    const double radius_m = radii_m_[id] + radii_m_[other];
    const double square = offset.squaredNorm();
    if (square >= radius_m * radius_m) continue;
    const double distance_m = std::sqrt(square);
    const Eigen::Vector2d away = distance_m > 0 ? Eigen::Vector2d(offset / distance_m)
                                                : Eigen::Vector2d(id < other ? -1.0 : 1.0, 0.0);
    push += 0.5 * (radius_m - distance_m) * away;
    deepest_m = std::max(deepest_m, radius_m - distance_m);
  }
  Eigen::Vector2d to = position + push;
  if (deepest_m > 0 && clearances_m_[id] < 2 * radii_m_[id] + 1)
    to = ways_.walkable().slide(positions_m_[id], to, tuning::kWallGap_m);
  relaxed_m_[id] = to;
  return deepest_m;
}

bool Crowd::is_queuing(uint32_t id) const {
  if (journeys_.doing(id) != Doing::kWalking) return false;
  const double slow_mps = tuning::kQueueSpeed * free_speeds_mps_[id];
  if (velocities_mps_[id].squaredNorm() > slow_mps * slow_mps) return false;
  const FlowField* field = journeys_.stop(id).field;
  const Eigen::Vector2d way = journeys_.direction(id, positions_m_[id]);
  for (uint32_t k = 0; k < neighbour_counts_[id]; ++k) {
    const Neighbour& near = neighbours_[id * kMaxNeighbours + k];
    const double reach_m = radii_m_[id] + radii_m_[near.id] + tuning::kQueueGap_m;
    if (near.square_m2 > reach_m * reach_m) return false;
    // Ahead within 60 degrees, and with the same way to go.
    const Eigen::Vector2d offset = positions_m_[near.id] - positions_m_[id];
    if (journeys_.doing(near.id) == Doing::kWalking && journeys_.stop(near.id).field == field &&
        way.dot(offset) > 0.5 * offset.norm())
      return true;
  }
  return false;
}

double Crowd::stalled_s_of(uint32_t id) const {
  return options_.step_s * static_cast<double>(steps_ - anchor_steps_[id]);
}

void Crowd::measure() {
  counters_.deepest_overlap_m = largest([this](uint32_t id) {
    double deepest_m = 0;
    for (uint32_t k = 0; k < neighbour_counts_[id]; ++k) {
      const Neighbour& near = neighbours_[id * kMaxNeighbours + k];
      deepest_m = std::max(deepest_m, radii_m_[id] + radii_m_[near.id] - std::sqrt(near.square_m2));
    }
    return deepest_m;
  });
  counters_.longest_stall_s = largest([this](uint32_t id) {
    const bool stands = journeys_.doing(id) != Doing::kWalking;
    if (stands || (positions_m_[id] - anchors_m_[id]).norm() >= kStall_m) {
      anchors_m_[id] = positions_m_[id];
      anchor_steps_[id] = steps_;
      queued_steps_[id] = 0;
    }
    queuing_[id] = is_queuing(id);
    if (queuing_[id] != 0) queued_steps_[id] += steps_a_decision_;
    return std::max(
        0.0, options_.step_s * static_cast<double>(steps_ - anchor_steps_[id] - queued_steps_[id]));
  });
  counters_.queuing = 0;
  for (const uint32_t id : grid_.order()) counters_.queuing += queuing_[id];
}

}  // namespace throng
