#include "scenes/run/body_avoidance_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>

#include "avatars/stepping/standing.h"
#include "base/portable_math.h"
#include "crowd/steering_state.h"

namespace throng {
namespace {

constexpr double kSearch_s = 0.4;
// Decision period of bodies that adapt or have to; twice as long for others.
constexpr double kDecision_s = 0.1;
// Two agents that approach at 1.5 m/s each cover 1.2 m until the next search. The other 1.8 m take
// two thirds of kAvoidanceHorizon_s.
constexpr float kSearch_m = 3;
constexpr float kWallReach_m = 0.9f;
enum : uint8_t { kAway, kFresh, kThere };
// Averaging times of velocities that are not known in advance, because roots jitter. Cadence, which
// looks farther ahead, uses the long one: evasive moves are short.
constexpr float kMean_s = 0.05f, kLongMean_s = 0.3f;
constexpr float kCadenceMean_s = 0.1f;
constexpr float kLanding_mps = 2.5f;
constexpr float kStrideScale_ps = 3;
constexpr double kLanding_s = 0.1, kCadence_s = 0.2;
// Maximum turn rates of hips. Lower for people who turn on the spot, because their feet step along.
constexpr float kHips_rps = 0.65f, kStandingHips_rps = 0.18f, kSlow_mps = 0.3f;
constexpr double kJump_m = 1;

bool is_external(const BodyStates& bodies, uint32_t id) {
  return !bodies.external_rows.empty() && bodies.external_rows[id] != nullptr;
}

std::optional<Eigen::Vector2f> next_of(const BodyStates& bodies, uint32_t id) {
  if (bodies.next_mps.empty() || std::isnan(bodies.next_mps[id].x())) return {};
  return bodies.next_mps[id];
}

/// Whether a new avatar stands, judged by its known velocity and gait speed.
bool comes_in_standing(const BodyStates& bodies, uint32_t id) {
  const Eigen::Vector2f next_mps = next_of(bodies, id).value_or(Eigen::Vector2f::Zero());
  return bodies.gait_mps[id] < kStanding_mps && next_mps.norm() < kStanding_mps;
}

int64_t steps_in(double time_s, const Scene& scene) {
  return std::max<int64_t>(1, std::llround(time_s / scene.step_s));
}

}  // namespace

BodyAvoidanceStage::BodyAvoidanceStage(const Scene& scene, const Posing& posing,
                                       const BodyStates& bodies, size_t avatars, SimdTarget simd,
                                       Workers& workers)
    : posing_(posing),
      workers_(workers),
      simd_(resolved(simd)),
      step_s_(static_cast<float>(scene.step_s)),
      steps_per_search_(steps_in(kSearch_s, scene)),
      steps_per_decision_(steps_in(kDecision_s, scene)),
      steps_per_landing_(steps_in(kLanding_s, scene)),
      steps_per_cadence_(steps_in(kCadence_s, scene)),
      walkable_(scene),
      grid_(scene.ground, avatars, simd),
      blocks_(blocks_of({bodies.types.data(), avatars})),
      states_(avatars),
      landings_m_(avatars),
      mean_velocities_mps_(avatars, Eigen::Vector2f::Zero()),
      last_m_(avatars, Eigen::Vector2d::Zero()),
      presence_(avatars),
      motions_(avatars),
      targets_(avatars),
      foot_targets_(avatars),
      surroundings_(avatars),
      farthest_m_(blocks_.size() + 1),
      slots_(avatars),
      found_(avatars * NeighbourGrid::kMaxNeighbours),
      counts_(avatars) {
  fresh_.reserve(avatars);
  middle_m_ = grid_.middle_m();
  size_t max_columns = 0, max_links = 0;
  for (size_t model = 0; model < posing.model_count(); ++model) {
    const Outline* outline = posing.outline_of(model);
    upper_bounds_.emplace_back();
    if (outline == nullptr) continue;
    upper_bounds_.back().emplace(posing.model(model), outline->columns);
    max_columns = std::max(max_columns, static_cast<size_t>(posing.column_count(model)));
    const UpperBodyBounds& upper_bounds = *upper_bounds_.back();
    max_links = std::max(max_links, static_cast<size_t>(upper_bounds.kinematics().output_count()));
  }
  scratch_.resize(static_cast<size_t>(workers.threads()));
  for (Scratch& scratch : scratch_) {
    scratch.rows.resize(kBatch * max_columns);
    scratch.poses.resize(kBatch * max_links);
  }
}

void BodyAvoidanceStage::archive(Archive& a, BodyStates& bodies) {
  a(steps_, presence_);
  const auto motion = [&a](AvoidanceMotion& m) {
    a(m.turn_rad, m.turn_rps, m.arms[0], m.arms[1], m.arms_ps[0], m.arms_ps[1], m.standing,
      m.standing_ps, m.has_constraints, m.is_urgent);
  };
  const auto numbers = [&a](auto& values) {
    for (auto& value : values) a(value);
  };
  for (size_t i = 0; i < states_.size(); ++i) {
    BodyState2d& state = states_[i];
    Eigen::Vector2f& mean_mps = mean_velocities_mps_[i];
    a(last_m_[i], state.vx_mps, state.vy_mps, mean_mps.x(), mean_mps.y(), state.phase,
      state.cadence_hz);
    motion(motions_[i]);
    motion(targets_[i]);
    a(foot_targets_[i].stride_scale);
    numbers(foot_targets_[i].landing_m);
    Surroundings& surroundings = surroundings_[i];
    a(surroundings.people_count, surroundings.wall_count);
    numbers(surroundings.people);
    for (Wall& wall : surroundings.walls) a(wall.x, wall.y, wall.offset_m);
    AvoidancePosture& posture = bodies.avoidance[i];
    a(posture.trunk_rad, posture.hips_rad, posture.arms[0], posture.arms[1], posture.standing,
      posture.stride_scale);
    numbers(posture.landing_m);
  }
  check_read(a, bodies);
  if (a.is_reading()) grid_.rebuild(last_m_, presence_);
}

void BodyAvoidanceStage::check_read(Archive& a, const BodyStates& bodies) const {
  constexpr float kMaxMagnitude = 1000;  // bound of all numbers here, in any unit
  for (const uint8_t state : presence_)
    if (state > kThere) a.reject("a presence of 0 to 2", std::to_string(state));
  for (size_t i = 0; i < states_.size(); ++i) {
    const Surroundings& surroundings = surroundings_[i];
    if (surroundings.people_count > NeighbourGrid::kMaxNeighbours ||
        surroundings.wall_count > kMaxAvoidedWalls)
      a.reject("at most ten neighbours and a few walls per person",
               std::to_string(surroundings.people_count));
    for (const uint32_t other : surroundings.neighbours())
      if (other >= states_.size()) a.reject("an avatar near a person", std::to_string(other));
    const AvoidancePosture& posture = bodies.avoidance[i];
    const AvoidanceMotion &m = motions_[i], &w = targets_[i];
    const auto is_sound = [](float value) { return std::abs(value) < kMaxMagnitude; };
    for (const float value : {states_[i].vx_mps, states_[i].vy_mps, mean_velocities_mps_[i].x(),
                              mean_velocities_mps_[i].y(), states_[i].phase, states_[i].cadence_hz,
                              m.turn_rad, m.turn_rps, m.arms_ps[0], m.arms_ps[1], m.standing_ps,
                              w.turn_rad, posture.trunk_rad, posture.hips_rad})
      if (!is_sound(value)) a.reject("a finite posture of body avoidance", std::to_string(value));
    for (const float share : {m.arms[0], m.arms[1], w.arms[0], w.arms[1], posture.arms[0],
                              posture.arms[1], m.standing, posture.standing})
      if (!(share >= 0 && share <= 1)) a.reject("an arm share from 0 to 1", std::to_string(share));
    for (const float stride_scale : {foot_targets_[i].stride_scale, posture.stride_scale})
      if (!(stride_scale > 0.1f && stride_scale < 10))
        a.reject("a stride scale from 0.1 to 10", std::to_string(stride_scale));
    for (size_t n = 0; n < 4; ++n)
      if (!(std::abs(foot_targets_[i].landing_m[n]) < 1 && std::abs(posture.landing_m[n]) < 1))
        a.reject("a landing place within 1 m", std::to_string(posture.landing_m[n]) + " m");
  }
}

/// Returns the largest displacement (m) of avatars that have not jumped.
double BodyAvoidanceStage::observe(const BodyStates& bodies, uint32_t first, uint32_t end) {
  double farthest_m2 = 0;
  const float share = step_s_ / (step_s_ + kMean_s);
  const float long_share = step_s_ / (step_s_ + kLongMean_s);
  const float cadence_share = step_s_ / (step_s_ + kCadenceMean_s);
  for (uint32_t id = first; id < end; ++id) {
    const RootPose& root = bodies.roots[id];
    const float w = root.world_from_root.w(), z = root.world_from_root.z();
    const float cos = w * w - z * z, sin = 2 * w * z;
    const float aside_m =
        bodies.scales[id] * posing_.gait_of(id).hips_offset_m(bodies.postures[id]);
    const Eigen::Vector2d at = root.position_m.head<2>();
    const Eigen::Vector2d moved_m = at - last_m_[id];
    last_m_[id] = at;
    BodyState2d& state = states_[id];
    // Position of the trunk, which sways. The velocity is that of the root, which does not.
    state.x_m = static_cast<float>(at.x() - middle_m_.x()) - aside_m * sin;
    state.y_m = static_cast<float>(at.y() - middle_m_.y()) + aside_m * cos;
    state.cos = cos;
    state.sin = sin;
    if (const float hips = bodies.avoidance[id].hips_rad; hips != 0) {
      const FloatSinCos turn = float_sin_cos(hips);
      state.cos = cos * turn.cos + sin * turn.sin;
      state.sin = sin * turn.cos - cos * turn.sin;
    }
    landings_m_[id] = bodies.avoidance[id].landing_m;
    const float phase = bodies.phases[id];
    const float cycles = phase - state.phase;
    state.phase = phase;
    state.turn_rad = motions_[id].turn_rad;
    state.arms = motions_[id].arms;
    state.scale = bodies.scales[id];
    const bool is_fresh = presence_[id] == kAway || moved_m.squaredNorm() > kJump_m * kJump_m;
    // An agent that enters standing has stood before.
    if (is_fresh) motions_[id].standing = comes_in_standing(bodies, id) ? 1 : 0;
    const Outline* outline = is_external(bodies, id) ? nullptr : posing_.gait_of(id).outline();
    // Of arms that move into a standing posture or out of it, the outline of the nearer posture.
    state.sweep = outline == nullptr ? nullptr
                  : motions_[id].standing > 0.5f
                      ? &outline->standing_sweep(bodies.standing[id])
                      : &outline->sweep_at(bodies.gait_mps[id], state.scale);
    state.sway_m = state.sweep == nullptr ? 0 : state.scale * state.sweep->sway_m();
    if (outline == nullptr)
      state.disc_m = state.scale * posing_.model(bodies.types[id]).footprint_radius_m();
    else
      state.disc_m = 0;
    if (is_fresh) {
      const Eigen::Vector2f next_mps = next_of(bodies, id).value_or(Eigen::Vector2f::Zero());
      state.vx_mps = next_mps.x();
      state.vy_mps = next_mps.y();
      state.cadence_hz = 0;
      mean_velocities_mps_[id] = next_mps;
      presence_[id] = kFresh;
      continue;
    }
    farthest_m2 = std::max(farthest_m2, moved_m.squaredNorm());
    state.cadence_hz +=
        cadence_share * ((cycles - std::floor(cycles)) / step_s_ - state.cadence_hz);
    const Eigen::Vector2f now_mps = moved_m.cast<float>() / step_s_;
    if (const std::optional<Eigen::Vector2f> next_mps = next_of(bodies, id)) {
      state.vx_mps = next_mps->x();
      state.vy_mps = next_mps->y();
    } else {
      state.vx_mps += share * (now_mps.x() - state.vx_mps);
      state.vy_mps += share * (now_mps.y() - state.vy_mps);
    }
    mean_velocities_mps_[id] += long_share * (now_mps - mean_velocities_mps_[id]);
  }
  return std::sqrt(farthest_m2);
}

/// Searches for all avatars, neighbours in space together.
void BodyAvoidanceStage::search_all() {
  grid_.rebuild(last_m_, presence_);
  const std::span<const uint32_t> order = grid_.order();
  std::iota(slots_.begin(), slots_.begin() + static_cast<ptrdiff_t>(order.size()), 0u);
  const std::span<const uint32_t> slots(slots_.data(), order.size());
  for_blocks_of(workers_, slots.size(), [&](size_t begin, size_t end, int) {
    grid_.nearest(slots.subspan(begin, end - begin), kSearch_m, found_.data(), counts_.data());
    for (size_t slot = begin; slot < end; ++slot) {
      Surroundings& surroundings = surroundings_[order[slot]];
      surroundings.people_count = counts_[slot];
      for (size_t i = 0; i < counts_[slot]; ++i)
        surroundings.people[i] = order[found_[NeighbourGrid::kMaxNeighbours * slot + i]];
      find_walls(last_m_[order[slot]], surroundings);
    }
  });
}

/// Searches for avatars that have entered or jumped, and for their neighbours.
void BodyAvoidanceStage::search_fresh() {
  fresh_.clear();
  for (uint32_t id = 0; id < presence_.size(); ++id)
    if (presence_[id] == kFresh) fresh_.push_back(id);
  if (fresh_.empty()) return;
  const size_t count = fresh_.size();
  if (count * (NeighbourGrid::kMaxNeighbours + 1) > presence_.size()) return search_all();
  if (count > grid_.free_insertions())
    grid_.rebuild(last_m_, presence_);
  else
    for (const uint32_t id : fresh_) grid_.insert(id, last_m_[id]);
  const auto search = [this](std::span<const uint32_t> ids) {
    for_blocks_of(workers_, ids.size(), [&](size_t begin, size_t end, int) {
      for (const uint32_t id : ids.subspan(begin, end - begin)) find_neighbours(id);
    });
  };
  search(fresh_);
  for (size_t i = 0; i < count; ++i)
    for (const uint32_t other : surroundings_[fresh_[i]].neighbours())
      if (presence_[other] != kFresh) fresh_.push_back(other);
  const auto neighbours = fresh_.begin() + static_cast<ptrdiff_t>(count);
  std::sort(neighbours, fresh_.end());  // avatars next to several are searched once
  fresh_.erase(std::unique(neighbours, fresh_.end()), fresh_.end());
  search(std::span(fresh_).subspan(count));
}

/// Finds what search_all() would, without sorting all avatars into cells.
void BodyAvoidanceStage::find_neighbours(uint32_t id) {
  struct Candidate {
    float square_m2;
    uint32_t id;
    bool operator<(const Candidate& other) const {
      return std::tie(square_m2, id) < std::tie(other.square_m2, other.id);
    }
  };
  constexpr size_t kMaxNeighbours = NeighbourGrid::kMaxNeighbours;
  std::array<Candidate, kMaxNeighbours> nearest;
  size_t count = 0;
  const auto local = [this](uint32_t body) -> Eigen::Vector2f {
    return (last_m_[body] - middle_m_).cast<float>();
  };
  const Eigen::Vector2f own = local(id);
  grid_.visit_near(last_m_[id], kSearch_m, [&](uint32_t other) {
    if (other == id || presence_[other] == kAway) return;
    const Eigen::Vector2f offset = local(other) - own;
    const Candidate candidate{offset.x() * offset.x() + offset.y() * offset.y(), other};
    if (candidate.square_m2 > kSearch_m * kSearch_m) return;
    const auto end = nearest.begin() + static_cast<ptrdiff_t>(count);
    const auto place = std::lower_bound(nearest.begin(), end, candidate);
    if (place == nearest.end() || (place != end && place->id == other)) return;
    count = std::min(count + 1, kMaxNeighbours);
    std::copy_backward(place, nearest.begin() + static_cast<ptrdiff_t>(count) - 1,
                       nearest.begin() + static_cast<ptrdiff_t>(count));
    *place = candidate;
  });
  Surroundings& surroundings = surroundings_[id];
  surroundings.people_count = static_cast<uint8_t>(count);
  for (size_t i = 0; i < count; ++i) surroundings.people[i] = nearest[i].id;
  find_walls(last_m_[id], surroundings);
}

void BodyAvoidanceStage::find_walls(const Eigen::Vector2d& position_m,
                                    Surroundings& surroundings) const {
  surroundings.wall_count = 0;
  for (const uint32_t footprint : walkable_.nearby_footprints(position_m)) {
    const Walkable::Nearest nearest = walkable_.nearest(footprint, position_m);
    if (nearest.distance_m > static_cast<double>(kWallReach_m)) continue;
    if (surroundings.wall_count == kMaxAvoidedWalls) return;
    const double offset_m = nearest.normal.dot(position_m - middle_m_) - nearest.distance_m;
    surroundings.walls[surroundings.wall_count++] = {static_cast<float>(nearest.normal.x()),
                                                     static_cast<float>(nearest.normal.y()),
                                                     static_cast<float>(offset_m)};
  }
}

AvoidanceMotion BodyAvoidanceStage::target_of(uint32_t id) const {
  const BodyState2d& own = states_[id];
  const Surroundings& surroundings = surroundings_[id];
  if (surroundings.people_count == 0 && surroundings.wall_count == 0) return {};
  static_assert(NeighbourGrid::kMaxNeighbours <= kMaxAvoidedBodies);
  std::array<const BodyState2d*, NeighbourGrid::kMaxNeighbours> neighbours;
  for (size_t i = 0; i < surroundings.people_count; ++i)
    neighbours[i] = &states_[surroundings.people[i]];
  std::array<WallState2d, kMaxAvoidedWalls> walls;
  for (size_t i = 0; i < surroundings.wall_count; ++i) {
    const Wall& wall = surroundings.walls[i];
    walls[i] = {-(own.cos * wall.x + own.sin * wall.y), -(own.cos * wall.y - own.sin * wall.x),
                wall.x * own.x_m + wall.y * own.y_m - wall.offset_m,
                -(wall.x * own.vx_mps + wall.y * own.vy_mps)};
  }
  return target_avoidance(own, {neighbours.data(), surroundings.people_count},
                          {walls.data(), surroundings.wall_count}, simd_);
}

bool BodyAvoidanceStage::is_turn_of(uint32_t id) const {
  const bool rests = motions_[id].is_at_rest() && targets_[id].is_at_rest();
  return (steps_ + id) % (rests ? 2 * steps_per_decision_ : steps_per_decision_) == 0;
}

/// Prefetches the data of neighbours, which are far apart in memory.
void BodyAvoidanceStage::fetch(uint32_t id) const {
  if (is_turn_of(id))
    for (const uint32_t other : surroundings_[id].neighbours()) __builtin_prefetch(&states_[other]);
}

void BodyAvoidanceStage::adapt_posture(uint32_t id, BodyStates& bodies) {
  AvoidanceMotion& motion = motions_[id];
  const bool is_fresh = presence_[id] == kFresh;
  presence_[id] = kThere;
  if (is_fresh || is_turn_of(id)) targets_[id] = target_of(id);
  // A person who has just entered has adapted to the others before.
  if (is_fresh) {
    targets_[id].standing = motion.standing;  // as observe() has set it
    motion = targets_[id];
  } else if (targets_[id].has_constraints || !motion.is_at_rest())
    follow(targets_[id], step_s_, motion);
  const bool stands_still = velocity_of(id).squaredNorm() < kStanding_mps * kStanding_mps;
  const bool poses =
      bodies.standing_time_s[id] >= kMaxStandingTime_s || (motion.standing > 0.5f && stands_still);
  if (poses || motion.standing > 0) follow_standing(poses, step_s_, motion);
  AvoidancePosture& posture = bodies.avoidance[id];
  posture.trunk_rad = motion.turn_rad - posture.hips_rad;
  const float slowest =
      std::min(mean_velocities_mps_[id].squaredNorm(), velocity_of(id).squaredNorm());
  const bool stands = slowest < kSlow_mps * kSlow_mps;
  const float max_rad = (stands ? kStandingHips_rps : kHips_rps) * step_s_;
  posture.hips_rad +=
      std::clamp(kHipsShare * motion.turn_rad - posture.hips_rad, -max_rad, max_rad);
  posture.arms = motion.arms;
  posture.standing = motion.standing;
}

WalkState BodyAvoidanceStage::steps_of(uint32_t id, const BodyStates& bodies,
                                       const Eigen::Vector2f& velocity_mps) const {
  const BodyState2d& state = states_[id];
  const RootPose& root = bodies.roots[id];
  const float w = root.world_from_root.w(), z = root.world_from_root.z();
  WalkState steps;
  const Eigen::Vector2d at = root.position_m.head<2>() - middle_m_;
  steps.root_m = at.cast<float>();
  steps.velocity_mps = velocity_mps;
  steps.ahead = {w * w - z * z, 2 * w * z};
  steps.scale = bodies.scales[id];
  steps.phase = bodies.phases[id];
  const Gait& gait = posing_.gait_of(id);
  steps.swing = &gait.swing();
  steps.track = gait.track_at(bodies.gait_mps[id], steps.scale);
  steps.cadence_hz = state.cadence_hz;
  steps.shift_m = {bodies.feet[0][id], bodies.feet[1][id], bodies.feet[3][id], bodies.feet[4][id]};
  steps.landing_m = landings_m_[id];
  return steps;
}

bool BodyAvoidanceStage::has_steps(uint32_t id, const BodyStates& bodies) const {
  return !is_external(bodies, id) && posing_.gait_of(id).has_legs();
}

RootMotion BodyAvoidanceStage::course_of(uint32_t id, const BodyStates& bodies) const {
  const Eigen::Vector2d at_m = bodies.roots[id].position_m.head<2>() - middle_m_;
  return {at_m.cast<float>(), mean_velocities_mps_[id]};
}

float BodyAvoidanceStage::target_stride_scale(uint32_t id, const BodyStates& bodies) const {
  constexpr float kReach_m = 1.6f;
  std::array<RootMotion, NeighbourGrid::kMaxNeighbours> neighbours;
  std::array<uint32_t, NeighbourGrid::kMaxNeighbours> ids;
  size_t count = 0;
  for (const uint32_t other : surroundings_[id].neighbours()) {
    const float dx = states_[other].x_m - states_[id].x_m,
                dy = states_[other].y_m - states_[id].y_m;
    if (dx * dx + dy * dy > kReach_m * kReach_m || !has_steps(other, bodies)) continue;
    neighbours[count] = course_of(other, bodies);
    ids[count++] = other;
  }
  const LegEncounters encounters =
      find_encounters({neighbours.data(), count}, course_of(id, bodies));
  if (encounters.count == 0) return 1;
  std::array<WalkState, LegEncounters::kMax> steps;
  for (size_t i = 0; i < encounters.count; ++i) {
    const uint32_t other = ids[encounters.all[i].neighbour];
    steps[i] = steps_of(other, bodies, mean_velocities_mps_[other]);
  }
  return stride_scale_for(steps_of(id, bodies, mean_velocities_mps_[id]),
                          {steps.data(), encounters.count}, encounters,
                          bodies.avoidance[id].stride_scale, simd_);
}

std::array<float, 4> BodyAvoidanceStage::target_landing_m(uint32_t id,
                                                          const BodyStates& bodies) const {
  std::array<float, 4> shifts_m{};
  if (surroundings_[id].people_count == 0) return shifts_m;
  const WalkState own = steps_of(id, bodies, velocity_of(id));
  for (size_t side = 0; side < 2; ++side) {
    FootPlacement landing(own, side, simd_);
    if (!landing.is_due()) continue;
    for (const uint32_t other : surroundings_[id].neighbours()) {
      const BodyState2d& state = states_[other];
      if (landing.may_conflict({state.x_m, state.y_m}, velocity_of(other)) &&
          has_steps(other, bodies))
        landing.add(steps_of(other, bodies, velocity_of(other)));
    }
    const Eigen::Vector2f shift_m = landing.shift_m();
    shifts_m[2 * side] = shift_m.x();
    shifts_m[2 * side + 1] = shift_m.y();
  }
  return shifts_m;
}

void BodyAvoidanceStage::place_feet(uint32_t id, BodyStates& bodies) {
  FootTargets& target = foot_targets_[id];
  const int64_t turn = steps_ + id;  // spreads avatars over the period
  if (turn % steps_per_landing_ == 0) target.landing_m = target_landing_m(id, bodies);
  if (turn % steps_per_cadence_ == 0) target.stride_scale = target_stride_scale(id, bodies);
  const auto approach = [&](float to, float max_ps, float& now) {
    now += std::clamp(to - now, -max_ps * step_s_, max_ps * step_s_);
  };
  AvoidancePosture& posture = bodies.avoidance[id];
  approach(target.stride_scale, kStrideScale_ps, posture.stride_scale);
  for (size_t i = 0; i < 4; ++i) approach(target.landing_m[i], kLanding_mps, posture.landing_m[i]);
}

/// Extends the bounds of stepping by the adapted posture. Postures that would leave the bounds of
/// all postures are dropped.
void BodyAvoidanceStage::extend_bounds(std::span<const uint32_t> ids, int worker,
                                       BodyStates& bodies) {
  const uint16_t type = bodies.types[ids.front()];
  const UpperBodyBounds& upper_bounds = *upper_bounds_[type];
  const RootSphere sphere = posing_.sphere(type);
  const RoundBounds all = {sphere.centre_m.z(), sphere.radius_m, sphere.upright_radius_m};
  const auto links = static_cast<size_t>(upper_bounds.kinematics().output_count());
  const auto columns = static_cast<size_t>(posing_.column_count(type));
  Scratch& scratch = scratch_[static_cast<size_t>(worker)];
  const std::span<float> rows(scratch.rows.data(), ids.size() * columns);
  const std::span<PartPose> poses(scratch.poses.data(), ids.size() * links);
  const std::array<RootFrame, kBatch> frames{};
  posing_.rows(ids, rows);
  forward_kinematics(upper_bounds.kinematics(), rows, {frames.data(), ids.size()}, poses, simd_);
  for (size_t i = 0; i < ids.size(); ++i) {
    const uint32_t id = ids[i];
    const std::optional<RootBox> upper =
        upper_bounds.box_within(poses.subspan(i * links, links), all, simd_);
    if (!upper) {
      bodies.avoidance[id].trunk_rad = 0;
      bodies.avoidance[id].arms = {};
      bodies.avoidance[id].standing = 0;
      continue;
    }
    const Gait& gait = posing_.gait_of(id);
    RootBox box = gait.box_of({bodies.bounds_x[id], bodies.bounds_y[id]}, 1);
    for (int axis = 0; axis < 2; ++axis) {
      box.min_m[axis] = std::min(box.min_m[axis], upper->min_m[axis]);
      box.max_m[axis] = std::max(box.max_m[axis], upper->max_m[axis]);
    }
    const WalkBounds bounds = gait.walk_bounds_of(box, 1);
    bodies.bounds_x[id] = bounds.x;
    bodies.bounds_y[id] = bounds.y;
  }
}

void BodyAvoidanceStage::step(std::span<const uint8_t> present, BodyStates& bodies) {
  workers_.for_blocks(static_cast<int>(blocks_.size()), [&](int index, int) {
    const BodyBlock& block = blocks_[static_cast<size_t>(index)];
    farthest_m_[static_cast<size_t>(index)] =
        observe(bodies, block.first, block.first + block.count);
  });
  for (size_t id = 0; !present.empty() && id < presence_.size(); ++id)
    if (present[id] == 0) presence_[id] = kAway;
  grid_.add_slack_m(*std::max_element(farthest_m_.begin(), farthest_m_.end()));
  if (steps_++ % steps_per_search_ == 0)
    search_all();
  else
    search_fresh();
  workers_.for_blocks(static_cast<int>(blocks_.size()), [&](int index, int worker) {
    const BodyBlock& block = blocks_[static_cast<size_t>(index)];
    if (!upper_bounds_[bodies.types[block.first]]) return;
    std::array<uint32_t, kBatch> turned;
    size_t count = 0;
    for (uint32_t id = block.first; id < block.first + block.count; ++id) {
      if (presence_[id] == kAway) bodies.avoidance[id] = {};
      if (presence_[id] == kAway || is_external(bodies, id)) continue;
      if (id + 1 < block.first + block.count) fetch(id + 1);
      adapt_posture(id, bodies);
      place_feet(id, bodies);
      if (bodies.avoidance[id].is_none()) continue;
      turned[count++] = id;
      if (count < kBatch) continue;
      extend_bounds(turned, worker, bodies);
      count = 0;
    }
    if (count > 0) extend_bounds({turned.data(), count}, worker, bodies);
  });
}

}  // namespace throng
