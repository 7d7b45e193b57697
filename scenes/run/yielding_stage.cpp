#include "scenes/run/yielding_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "avatars/stepping/standing.h"
#include "base/elementary.h"

namespace throng {
namespace {

constexpr double kSearch_s = 0.4;
// Whoever gives way or wants to decides so often, all others half as often.
constexpr double kDecision_s = 0.1;
// Two who walk towards each other at 1.5 m/s each until they are looked up again and half as far
// ahead again as bodies look.
constexpr float kSearch_m = 3;
constexpr float kWallReach_m = 0.9f;
enum : uint8_t { kAway, kFresh, kThere };
// Velocities that nobody knows beforehand are means over about so long: what moves a root may
// tremble. Rhythms, which look farther ahead, go by the long ones: whoever swerves will not for
// long.
constexpr float kMean_s = 0.05f, kLongMean_s = 0.3f;
constexpr float kRhythmMean_s = 0.1f;
// The place where a foot is to land changes no faster.
constexpr float kLanding_mps = 2.5f;
// Strides get longer or shorter no faster.
constexpr float kStretch_ps = 3;
// What is wanted of steps and strides is decided so often.
constexpr double kLanding_s = 0.1, kRhythm_s = 0.2;
// Hips turn no faster; of those who stand and turn on the spot besides, slower: feet step along.
constexpr float kHips_rps = 0.65f, kStandingHips_rps = 0.18f, kSlow_mps = 0.3f;
// Nobody goes so far in a step: a jump.
constexpr double kJump_m = 1;

/// Something outside moves it.
bool is_held(const BodyStates& bodies, uint32_t id) {
  return !bodies.held_rows.empty() && bodies.held_rows[id] != nullptr;
}

/// The velocity that it is about to have, where that is known.
std::optional<Eigen::Vector2f> next_of(const BodyStates& bodies, uint32_t id) {
  if (bodies.next_mps.empty() || std::isnan(bodies.next_mps[id].x())) return {};
  return bodies.next_mps[id];
}

/// As far as its velocity is known beforehand, and as fast as its gait.
bool comes_in_standing(const BodyStates& bodies, uint32_t id) {
  const Eigen::Vector2f next_mps = next_of(bodies, id).value_or(Eigen::Vector2f::Zero());
  return bodies.gait_mps[id] < kStanding_mps && next_mps.norm() < kStanding_mps;
}

int64_t steps_in(double time_s, const Scene& scene) {
  return std::max<int64_t>(1, std::llround(time_s / scene.step_s));
}

}  // namespace

YieldingStage::YieldingStage(const Scene& scene, const Posing& posing, const BodyStates& bodies,
                             size_t avatars, SimdTarget simd, Workers& workers)
    : posing_(posing),
      workers_(workers),
      simd_(resolved(simd)),
      step_s_(static_cast<float>(scene.step_s)),
      steps_a_search_(steps_in(kSearch_s, scene)),
      steps_a_decision_(steps_in(kDecision_s, scene)),
      steps_a_landing_(steps_in(kLanding_s, scene)),
      steps_a_rhythm_(steps_in(kRhythm_s, scene)),
      walkable_(scene),
      grid_(scene.ground, avatars, simd),
      blocks_(blocks_of({bodies.types.data(), avatars})),
      seen_(avatars),
      landings_m_(avatars),
      long_ways_mps_(avatars, Eigen::Vector2f::Zero()),
      last_m_(avatars, Eigen::Vector2d::Zero()),
      was_there_(avatars),
      motions_(avatars),
      wanted_(avatars),
      footings_(avatars),
      around_(avatars),
      slots_(avatars),
      found_(avatars * NeighbourGrid::kMost),
      counts_(avatars) {
  middle_m_ = grid_.middle_m();
  size_t most_columns = 0, most_links = 0;
  for (size_t model = 0; model < posing.model_count(); ++model) {
    const Outline* outline = posing.outline_of(model);
    rooms_.emplace_back();
    if (outline == nullptr) continue;
    rooms_.back().emplace(posing.model(model), outline->columns);
    most_columns = std::max(most_columns, static_cast<size_t>(posing.column_count(model)));
    const UpperRoom& room = *rooms_.back();
    most_links = std::max(most_links, static_cast<size_t>(room.kinematics().output_count()));
  }
  scratch_.resize(static_cast<size_t>(workers.threads()));
  for (Scratch& scratch : scratch_) {
    scratch.rows.resize(kBatch * most_columns);
    scratch.poses.resize(kBatch * most_links);
  }
}

void YieldingStage::archive(Archive& a, BodyStates& bodies) {
  a(steps_, was_there_);
  const auto motion = [&a](YieldMotion& m) {
    a(m.turn_rad, m.turn_rps, m.arms[0], m.arms[1], m.arms_ps[0], m.arms_ps[1], m.standing,
      m.standing_ps, m.is_near, m.is_pressed);
  };
  const auto numbers = [&a](auto& values) {
    for (auto& value : values) a(value);
  };
  for (size_t i = 0; i < seen_.size(); ++i) {
    SeenBody& seen = seen_[i];
    Eigen::Vector2f& way = long_ways_mps_[i];
    a(last_m_[i], seen.vx_mps, seen.vy_mps, way.x(), way.y(), seen.phase, seen.cycles_ps);
    motion(motions_[i]);
    motion(wanted_[i]);
    a(footings_[i].stretch);
    numbers(footings_[i].landing_m);
    Around& around = around_[i];
    a(around.people_count, around.wall_count);
    numbers(around.people);
    for (Wall& wall : around.walls) a(wall.x, wall.y, wall.offset_m);
    Yield& yield = bodies.yields[i];
    a(yield.trunk_rad, yield.hips_rad, yield.arms[0], yield.arms[1], yield.standing, yield.stretch);
    numbers(yield.landing_m);
  }
  check_read(a, bodies);
}

void YieldingStage::check_read(Archive& a, const BodyStates& bodies) const {
  constexpr float kMost = 1000;  // of any number here, in whatever unit
  for (const uint8_t state : was_there_)
    if (state > kThere) a.refuse("a person who is away, fresh or there", std::to_string(state));
  for (size_t i = 0; i < seen_.size(); ++i) {
    const Around& around = around_[i];
    if (around.people_count > NeighbourGrid::kMost || around.wall_count > kMostNearWalls)
      a.refuse("few near a person", std::to_string(around.people_count));
    for (const uint32_t other : around.near())
      if (other >= seen_.size()) a.refuse("an avatar near a person", std::to_string(other));
    const Yield& yield = bodies.yields[i];
    const YieldMotion &m = motions_[i], &w = wanted_[i];
    const auto is_sound = [](float value) { return std::abs(value) < kMost; };
    for (const float value :
         {seen_[i].vx_mps, seen_[i].vy_mps, long_ways_mps_[i].x(), long_ways_mps_[i].y(),
          seen_[i].phase, seen_[i].cycles_ps, m.turn_rad, m.turn_rps, m.arms_ps[0], m.arms_ps[1],
          m.standing_ps, w.turn_rad, yield.trunk_rad, yield.hips_rad})
      if (!is_sound(value)) a.refuse("how a body gives way", std::to_string(value));
    for (const float share : {m.arms[0], m.arms[1], w.arms[0], w.arms[1], yield.arms[0],
                              yield.arms[1], m.standing, yield.standing})
      if (!(share >= 0 && share <= 1)) a.refuse("a share of an arm", std::to_string(share));
    for (const float stretch : {footings_[i].stretch, yield.stretch})
      if (!(stretch > 0.1f && stretch < 10))
        a.refuse("a length of strides", std::to_string(stretch));
    for (size_t n = 0; n < 4; ++n)
      if (!(std::abs(footings_[i].landing_m[n]) < 1 && std::abs(yield.landing_m[n]) < 1))
        a.refuse("a foot near its landing place", std::to_string(yield.landing_m[n]) + " m");
  }
}

void YieldingStage::see(const BodyStates& bodies, uint32_t first, uint32_t end) {
  const float share = step_s_ / (step_s_ + kMean_s);
  const float long_share = step_s_ / (step_s_ + kLongMean_s);
  const float rhythm_share = step_s_ / (step_s_ + kRhythmMean_s);
  for (uint32_t id = first; id < end; ++id) {
    const RootPose& root = bodies.roots[id];
    const float w = root.world_from_root.w(), z = root.world_from_root.z();
    const float cos = w * w - z * z, sin = 2 * w * z;
    const float aside_m =
        bodies.scales[id] * posing_.gait_of(id).trunk_aside_m(bodies.postures[id]);
    const Eigen::Vector2d at = root.position_m.head<2>();
    const Eigen::Vector2d way = at - last_m_[id];
    last_m_[id] = at;
    SeenBody& seen = seen_[id];
    // The trunk's place, which sways; its way is the root's, which does not.
    seen.x_m = static_cast<float>(at.x() - middle_m_.x()) - aside_m * sin;
    seen.y_m = static_cast<float>(at.y() - middle_m_.y()) + aside_m * cos;
    seen.cos = cos;
    seen.sin = sin;
    if (const float hips = bodies.yields[id].hips_rad; hips != 0) {
      const FloatSinCos turn = float_sin_cos(hips);
      seen.cos = cos * turn.cos + sin * turn.sin;
      seen.sin = sin * turn.cos - cos * turn.sin;
    }
    landings_m_[id] = bodies.yields[id].landing_m;
    const float phase = bodies.phases[id];
    const float cycles = phase - seen.phase;
    seen.phase = phase;
    seen.turn_rad = motions_[id].turn_rad;
    seen.arms = motions_[id].arms;
    seen.scale = bodies.scales[id];
    const bool is_fresh = was_there_[id] == kAway || way.squaredNorm() > kJump_m * kJump_m;
    // A person who comes in standing has stood before.
    if (is_fresh) motions_[id].standing = comes_in_standing(bodies, id) ? 1 : 0;
    const Outline* outline = is_held(bodies, id) ? nullptr : posing_.gait_of(id).outline();
    // Of arms on their way into a posture or back, where they are nearer to.
    seen.swung = outline == nullptr ? nullptr
                 : motions_[id].standing > 0.5f
                     ? &outline->swung_in(bodies.standing[id])
                     : &outline->swung_at(bodies.gait_mps[id], seen.scale);
    seen.sway_m = seen.swung == nullptr ? 0 : seen.scale * seen.swung->sway_m();
    if (outline == nullptr)
      seen.disc_m = seen.scale * posing_.model(bodies.types[id]).footprint_radius_m();
    else
      seen.disc_m = 0;
    if (is_fresh) {
      const Eigen::Vector2f next_mps = next_of(bodies, id).value_or(Eigen::Vector2f::Zero());
      seen.vx_mps = next_mps.x();
      seen.vy_mps = next_mps.y();
      seen.cycles_ps = 0;
      long_ways_mps_[id] = next_mps;
      was_there_[id] = kFresh;
      continue;
    }
    seen.cycles_ps += rhythm_share * ((cycles - std::floor(cycles)) / step_s_ - seen.cycles_ps);
    const Eigen::Vector2f now_mps = way.cast<float>() / step_s_;
    if (const std::optional<Eigen::Vector2f> next_mps = next_of(bodies, id)) {
      seen.vx_mps = next_mps->x();
      seen.vy_mps = next_mps->y();
    } else {
      seen.vx_mps += share * (now_mps.x() - seen.vx_mps);
      seen.vy_mps += share * (now_mps.y() - seen.vy_mps);
    }
    long_ways_mps_[id] += long_share * (now_mps - long_ways_mps_[id]);
  }
}

void YieldingStage::search(std::span<const uint32_t> slots, const BodyStates& bodies) {
  const std::span<const uint32_t> order = grid_.order();
  constexpr size_t kBlock = 256;
  const auto blocks = static_cast<int>((slots.size() + kBlock - 1) / kBlock);
  workers_.for_blocks(blocks, [&](int block, int) {
    const size_t begin = static_cast<size_t>(block) * kBlock;
    const auto some = slots.subspan(begin, std::min(kBlock, slots.size() - begin));
    grid_.nearest(some, kSearch_m, found_.data(), counts_.data());
    for (const uint32_t slot : some) {
      Around& around = around_[order[slot]];
      around.people_count = counts_[slot];
      for (size_t i = 0; i < counts_[slot]; ++i)
        around.people[i] = order[found_[NeighbourGrid::kMost * slot + i]];
      find_walls(bodies.roots[order[slot]].position_m.head<2>(), around);
    }
  });
}

void YieldingStage::search_all(std::span<const uint8_t> present, const BodyStates& bodies) {
  grid_.rebuild({last_m_.data(), last_m_.size()}, present);
  slots_.resize(grid_.order().size());
  std::iota(slots_.begin(), slots_.end(), 0u);
  search(slots_, bodies);
}

/// Whoever has come in since the latest search sees the others, and those near see them.
void YieldingStage::search_fresh(std::span<const uint8_t> present, const BodyStates& bodies) {
  const auto fresh = static_cast<size_t>(std::count(was_there_.begin(), was_there_.end(), kFresh));
  if (fresh == 0) return;
  if (fresh * (NeighbourGrid::kMost + 1) > was_there_.size()) return search_all(present, bodies);
  grid_.rebuild({last_m_.data(), last_m_.size()}, present);
  const std::span<const uint32_t> order = grid_.order();
  slots_.clear();
  for (uint32_t slot = 0; slot < order.size(); ++slot)
    if (was_there_[order[slot]] == kFresh) slots_.push_back(slot);
  search(slots_, bodies);
  for (size_t i = 0; i < fresh; ++i) {
    const uint32_t* const found = found_.data() + NeighbourGrid::kMost * slots_[i];
    for (size_t k = 0; k < counts_[slots_[i]]; ++k)
      if (was_there_[order[found[k]]] != kFresh) slots_.push_back(found[k]);
  }
  const auto near = slots_.begin() + static_cast<std::ptrdiff_t>(fresh);
  std::sort(near, slots_.end());  // whoever has several near is looked up once
  slots_.erase(std::unique(near, slots_.end()), slots_.end());
  search(std::span(slots_).subspan(fresh), bodies);
}

void YieldingStage::find_walls(const Eigen::Vector2d& position_m, Around& around) const {
  around.wall_count = 0;
  for (const uint32_t footprint : walkable_.near(position_m)) {
    const Walkable::Nearest nearest = walkable_.nearest(footprint, position_m);
    if (nearest.distance_m > static_cast<double>(kWallReach_m)) continue;
    if (around.wall_count == kMostNearWalls) return;
    const double offset_m = nearest.normal.dot(position_m - middle_m_) - nearest.distance_m;
    around.walls[around.wall_count++] = {static_cast<float>(nearest.normal.x()),
                                         static_cast<float>(nearest.normal.y()),
                                         static_cast<float>(offset_m)};
  }
}

YieldMotion YieldingStage::wanted_of(uint32_t id) const {
  const SeenBody& own = seen_[id];
  const Around& around = around_[id];
  if (around.people_count == 0 && around.wall_count == 0) return {};
  static_assert(NeighbourGrid::kMost <= kMostNear);
  std::array<const SeenBody*, NeighbourGrid::kMost> near;
  for (size_t i = 0; i < around.people_count; ++i) near[i] = &seen_[around.people[i]];
  std::array<NearWall, kMostNearWalls> walls;
  for (size_t i = 0; i < around.wall_count; ++i) {
    const Wall& wall = around.walls[i];
    walls[i] = {-(own.cos * wall.x + own.sin * wall.y), -(own.cos * wall.y - own.sin * wall.x),
                wall.x * own.x_m + wall.y * own.y_m - wall.offset_m,
                -(wall.x * own.vx_mps + wall.y * own.vy_mps)};
  }
  return wanted_yield(own, {near.data(), around.people_count}, {walls.data(), around.wall_count},
                      simd_);
}

bool YieldingStage::is_turn_of(uint32_t id) const {
  const bool rests = motions_[id].is_at_rest() && wanted_[id].is_at_rest();
  return (steps_ + id) % (rests ? 2 * steps_a_decision_ : steps_a_decision_) == 0;
}

/// Asks for what deciding about somebody will read: others are far apart in memory.
void YieldingStage::fetch(uint32_t id) const {
  if (is_turn_of(id))
    for (const uint32_t other : around_[id].near()) __builtin_prefetch(&seen_[other]);
}

void YieldingStage::give_way(uint32_t id, BodyStates& bodies) {
  YieldMotion& motion = motions_[id];
  const bool is_fresh = was_there_[id] == kFresh;
  was_there_[id] = kThere;
  if (is_fresh || is_turn_of(id)) wanted_[id] = wanted_of(id);
  // A person who has just come in has seen the others before.
  if (is_fresh) {
    wanted_[id].standing = motion.standing;  // as see() has set it
    motion = wanted_[id];
  } else if (wanted_[id].is_near || !motion.is_at_rest())
    follow(wanted_[id], step_s_, motion);
  const bool stands_still = velocity_of(id).squaredNorm() < kStanding_mps * kStanding_mps;
  const bool poses = bodies.stood_s[id] >= kStood_s || (motion.standing > 0.5f && stands_still);
  if (poses || motion.standing > 0) follow_standing(poses, step_s_, motion);
  Yield& yield = bodies.yields[id];
  yield.trunk_rad = motion.turn_rad - yield.hips_rad;
  const float slowest = std::min(long_ways_mps_[id].squaredNorm(), velocity_of(id).squaredNorm());
  const bool stands = slowest < kSlow_mps * kSlow_mps;
  const float most_rad = (stands ? kStandingHips_rps : kHips_rps) * step_s_;
  yield.hips_rad += std::clamp(kHipsShare * motion.turn_rad - yield.hips_rad, -most_rad, most_rad);
  yield.arms = motion.arms;
  yield.standing = motion.standing;
}

Steps YieldingStage::steps_of(uint32_t id, const BodyStates& bodies,
                              const Eigen::Vector2f& velocity_mps) const {
  const SeenBody& seen = seen_[id];
  const RootPose& root = bodies.roots[id];
  const float w = root.world_from_root.w(), z = root.world_from_root.z();
  Steps steps;
  const Eigen::Vector2d at = root.position_m.head<2>() - middle_m_;
  steps.root_m = at.cast<float>();
  steps.velocity_mps = velocity_mps;
  steps.ahead = {w * w - z * z, 2 * w * z};
  steps.scale = bodies.scales[id];
  steps.phase = bodies.phases[id];
  const Gait& gait = posing_.gait_of(id);
  steps.swing = &gait.swing();
  steps.track = gait.track_at(bodies.gait_mps[id], steps.scale);
  steps.cycles_ps = seen.cycles_ps;
  steps.shift_m = {bodies.feet[0][id], bodies.feet[1][id], bodies.feet[3][id], bodies.feet[4][id]};
  steps.landing_m = landings_m_[id];
  return steps;
}

bool YieldingStage::has_steps(uint32_t id, const BodyStates& bodies) const {
  return !is_held(bodies, id) && posing_.gait_of(id).has_legs();
}

Course YieldingStage::course_of(uint32_t id, const BodyStates& bodies) const {
  const Eigen::Vector2d at_m = bodies.roots[id].position_m.head<2>() - middle_m_;
  return {at_m.cast<float>(), long_ways_mps_[id]};
}

float YieldingStage::wanted_stretch(uint32_t id, const BodyStates& bodies) const {
  constexpr float kReach_m = 1.6f;
  std::array<Course, NeighbourGrid::kMost> near;
  std::array<uint32_t, NeighbourGrid::kMost> ids;
  size_t count = 0;
  for (const uint32_t other : around_[id].near()) {
    const float dx = seen_[other].x_m - seen_[id].x_m, dy = seen_[other].y_m - seen_[id].y_m;
    if (dx * dx + dy * dy > kReach_m * kReach_m || !has_steps(other, bodies)) continue;
    near[count] = course_of(other, bodies);
    ids[count++] = other;
  }
  const Meetings meetings = meetings_with({near.data(), count}, course_of(id, bodies));
  if (meetings.count == 0) return 1;
  std::array<Steps, Meetings::kMost> steps;
  for (size_t i = 0; i < meetings.count; ++i) {
    const uint32_t other = ids[meetings.all[i].who];
    steps[i] = steps_of(other, bodies, long_ways_mps_[other]);
  }
  return stretch_for(steps_of(id, bodies, long_ways_mps_[id]), {steps.data(), meetings.count},
                     meetings, bodies.yields[id].stretch, simd_);
}

std::array<float, 4> YieldingStage::wanted_landing_m(uint32_t id, const BodyStates& bodies) const {
  std::array<float, 4> shifts_m{};
  if (around_[id].people_count == 0) return shifts_m;
  const Steps own = steps_of(id, bodies, velocity_of(id));
  for (size_t side = 0; side < 2; ++side) {
    Landing landing(own, side, simd_);
    if (!landing.is_due()) continue;
    for (const uint32_t other : around_[id].near()) {
      const SeenBody& seen = seen_[other];
      if (landing.may_meet({seen.x_m, seen.y_m}, velocity_of(other)) && has_steps(other, bodies))
        landing.add(steps_of(other, bodies, velocity_of(other)));
    }
    const Eigen::Vector2f shift_m = landing.shift_m();
    shifts_m[2 * side] = shift_m.x();
    shifts_m[2 * side + 1] = shift_m.y();
  }
  return shifts_m;
}

void YieldingStage::place_feet(uint32_t id, BodyStates& bodies) {
  Footing& wanted = footings_[id];
  const int64_t turn = steps_ + id;  // not everybody's at once
  if (turn % steps_a_landing_ == 0) wanted.landing_m = wanted_landing_m(id, bodies);
  if (turn % steps_a_rhythm_ == 0) wanted.stretch = wanted_stretch(id, bodies);
  const auto approach = [&](float to, float most_ps, float& now) {
    now += std::clamp(to - now, -most_ps * step_s_, most_ps * step_s_);
  };
  Yield& yield = bodies.yields[id];
  approach(wanted.stretch, kStretch_ps, yield.stretch);
  for (size_t i = 0; i < 4; ++i) approach(wanted.landing_m[i], kLanding_mps, yield.landing_m[i]);
}

/// The room that stepping knows holds the body as its gait has it; this adds the body as it has
/// given way. Who would leave the room of all postures does not give way.
void YieldingStage::make_room(std::span<const uint32_t> ids, int worker, BodyStates& bodies) {
  const uint16_t type = bodies.types[ids.front()];
  const UpperRoom& room = *rooms_[type];
  const RootSphere sphere = posing_.sphere(type);
  const RoundRoom all = {sphere.centre_m.z(), sphere.radius_m, sphere.upright_radius_m};
  const auto links = static_cast<size_t>(room.kinematics().output_count());
  const auto columns = static_cast<size_t>(posing_.column_count(type));
  Scratch& scratch = scratch_[static_cast<size_t>(worker)];
  const std::span<float> rows(scratch.rows.data(), ids.size() * columns);
  const std::span<PartPose> poses(scratch.poses.data(), ids.size() * links);
  const std::array<RootFrame, kBatch> frames{};
  posing_.rows(ids, rows);
  forward_kinematics(room.kinematics(), rows, {frames.data(), ids.size()}, poses, simd_);
  for (size_t i = 0; i < ids.size(); ++i) {
    const uint32_t id = ids[i];
    const std::optional<RootBox> upper =
        room.box_within(poses.subspan(i * links, links), all, simd_);
    if (!upper) {
      bodies.yields[id].trunk_rad = 0;
      bodies.yields[id].arms = {};
      bodies.yields[id].standing = 0;
      continue;
    }
    const Gait& gait = posing_.gait_of(id);
    RootBox box = gait.box_of({bodies.room_x[id], bodies.room_y[id]}, 1);
    for (int axis = 0; axis < 2; ++axis) {
      box.min_m[axis] = std::min(box.min_m[axis], upper->min_m[axis]);
      box.max_m[axis] = std::max(box.max_m[axis], upper->max_m[axis]);
    }
    const WalkRoom held = gait.room_of(box, 1);
    bodies.room_x[id] = held.x;
    bodies.room_y[id] = held.y;
  }
}

void YieldingStage::step(std::span<const uint8_t> present, BodyStates& bodies) {
  workers_.for_blocks(static_cast<int>(blocks_.size()), [&](int index, int) {
    const BodyBlock& block = blocks_[static_cast<size_t>(index)];
    see(bodies, block.first, block.first + block.count);
  });
  for (size_t id = 0; !present.empty() && id < was_there_.size(); ++id)
    if (present[id] == 0) was_there_[id] = kAway;
  if (steps_++ % steps_a_search_ == 0)
    search_all(present, bodies);
  else
    search_fresh(present, bodies);
  workers_.for_blocks(static_cast<int>(blocks_.size()), [&](int index, int worker) {
    const BodyBlock& block = blocks_[static_cast<size_t>(index)];
    if (!rooms_[bodies.types[block.first]]) return;
    std::array<uint32_t, kBatch> turned;
    size_t count = 0;
    for (uint32_t id = block.first; id < block.first + block.count; ++id) {
      if (was_there_[id] == kAway) bodies.yields[id] = {};
      if (was_there_[id] == kAway || is_held(bodies, id)) continue;
      if (id + 1 < block.first + block.count) fetch(id + 1);
      give_way(id, bodies);
      place_feet(id, bodies);
      if (bodies.yields[id].is_none()) continue;
      turned[count++] = id;
      if (count < kBatch) continue;
      make_room(turned, worker, bodies);
      count = 0;
    }
    if (count > 0) make_room({turned.data(), count}, worker, bodies);
  });
}

}  // namespace throng
