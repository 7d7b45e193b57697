#include "scenes/run/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

#include "base/elementary.h"
#include "scenes/box/box_world.h"
#include "scenes/box/loose_parts.h"
#include "scenes/crowd/spawn.h"
#include "scenes/file/shapes.h"
#include "scenes/run/drive.h"
#include "scenes/run/kinds.h"
#include "scenes/run/posing.h"
#include "scenes/run/run_identity.h"
#include "scenes/run/walk.h"
#include "scenes/ways/ways.h"

namespace throng {
namespace {

using Clock = std::chrono::steady_clock;

/// Avatars a block: a posture row takes about 50 ns, a state less.
constexpr uint32_t kBlock = 256;

double nanoseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

/// Loads what the scene names but does not hold yet.
Scene with_bodies(Scene scene) {
  for (Group& group : scene.groups) {
    if (group.body == nullptr) group.body = load_model(group.model);
    keep_own_size(group);
  }
  if (scene.box && scene.box->body == nullptr) scene.box->body = load_model(scene.box->model);
  scene.content_hash = content_hash_of(scene);
  return scene;
}

std::optional<BoxWorld> box_of(const Scene& scene,
                               std::span<const std::shared_ptr<const Model>> parts) {
  if (!scene.box) return std::nullopt;
  const PartsBox& box = *scene.box;
  std::vector<double> radii_m;
  for (const std::shared_ptr<const Model>& part : parts) radii_m.push_back(reach_m(*part));
  BoxWorldOptions options;
  options.seed = scene.seed;
  if (!scene.file.empty()) options.name = scene.file.string();
  options.edge_m = box.edge_m;
  options.step_s = scene.step_s;
  options.min_speed_mps = box.min_speed_mps;
  options.max_speed_mps = box.max_speed_mps;
  options.max_spin_radps = box.max_spin_radps;
  return BoxWorld::of_kinds(options, radii_m, static_cast<size_t>(box.count),
                            static_cast<size_t>(box.static_every));
}

std::vector<Posing::Styles> styles_by_kind(const Kinds& kinds, const Spawned& spawned) {
  std::vector<Posing::Styles> styles(kinds.models.size());
  for (const Person& person : spawned.people)
    styles[kinds.of_group[person.group]].set(static_cast<size_t>(person.style));
  return styles;
}

}  // namespace

struct Simulation::State {
  State(Scene scene_in, const SimulationOptions& options_in);

  void archive(Archive& a);
  void place_bodies();
  void place_people();
  void place_parts();
  void place_driven();
  void describe_run();
  void cut_blocks();
  void move();
  void update_bodies();
  WalkNow move_root(uint32_t id);
  void update_parts();
  void update_postures();
  BodiesView bodies_there();
  void split_times(double steering_ns, double postures_ns);
  void fill_frame();

  /// Consecutive avatars of one model.
  struct Block {
    uint32_t first = 0;
    uint32_t count = 0;
  };

  SimulationOptions options;
  SimdTarget simd;
  Scene scene;
  Workers workers;
  Kinds kinds;
  const std::vector<std::shared_ptr<const Model>>& models;  ///< of kinds
  Ways ways;
  Spawned spawned;
  Crowd crowd;
  std::optional<BoxWorld> box;  ///< then the crowd is empty
  size_t avatars;               ///< people, or parts in the box
  BodyStates bodies;
  std::vector<float> speeds_mps;  ///< of the roots, by avatar
  std::vector<double> rises_m;    ///< of the roots above the ground, by avatar
  Posing posing;
  DrivenAvatars driven;
  std::vector<bool> is_driven_kind;  ///< by kind
  std::vector<uint32_t> ids;
  BodyStates there;  ///< of bodies that are in the scene, where some may be absent
  std::vector<uint32_t> there_ids;
  std::vector<Block> blocks;
  std::vector<float> postures;
  std::vector<size_t> posture_offsets;
  std::unique_ptr<Culler> culler;
  RunInfo info;
  Frame frame;
  FrameTimes times;
  int64_t frames = 0;
  uint64_t begins = 0;
  uint64_t ends = 0;
};

Simulation::State::State(Scene scene_in, const SimulationOptions& options_in)
    : options(options_in),
      simd(resolved(options.simd)),
      scene(with_bodies(std::move(scene_in))),
      workers(options.threads),
      kinds(kinds_of(scene)),
      models(kinds.models),
      ways(scene, workers),
      spawned(spawn(scene, ways)),
      crowd(ways, spawned.people, {scene.seed, scene.step_s, scene.steering, options.simd},
            workers),
      box(box_of(scene, models)),
      avatars(box ? box->size() : crowd.size()),
      posing(models, styles_by_kind(kinds, spawned), bodies, workers) {
  place_bodies();
  describe_run();
  cut_blocks();
  place_driven();
  std::vector<std::shared_ptr<const BodyType>> types;
  for (size_t i = 0; i < models.size(); ++i)
    types.push_back(
        body_type(*models[i], is_driven_kind[i] ? driven_sphere(*models[i]) : posing.sphere(i)));
  for (const Obstacle& obstacle : scene.obstacles) types.push_back(obstacle_type(obstacle));
  CullerOptions culling;
  culling.part_volume = scene.part_volume;
  culling.exact = scene.exact;
  culling.pair_search = options.pair_search;
  culling.simd = options.simd;
  culling.deadline_ms = options.deadline_ms;
  culling.deadline_tests = options.deadline_tests;
  culling.strategy = options.strategy;
  culler = std::make_unique<Culler>(std::move(types), culling, workers);
}

void Simulation::State::archive(Archive& a) {
  a(frames, begins, ends, frame.utime_us, bodies.phases, bodies.gait_mps);
  for (std::vector<float>& numbers : bodies.feet) a(numbers);
  for (size_t i = 0; i < avatars; ++i)
    a(bodies.roots[i].position_m, bodies.roots[i].world_from_root, speeds_mps[i]);
  for (const float speed : bodies.gait_mps)
    if (!(speed >= kNotComeIn && speed < 1000)) a.refuse("a speed to walk at", "another");
  constexpr float kFarFoot_m = 10;
  for (const std::vector<float>& numbers : bodies.feet)
    for (const float number : numbers)
      if (!(std::abs(number) < kFarFoot_m)) a.refuse("feet near their body", "others");
  for (const float phase : bodies.phases)
    if (!(phase >= 0 && phase <= 1)) a.refuse("a phase from 0 to 1", "another");
  if (box)
    box->archive(a);
  else
    crowd.archive(a);
  driven.archive(a);
  culler->archive(a);
}

void Simulation::State::place_parts() {
  for (size_t i = 0; i < box->size(); ++i) {
    bodies.types.push_back(static_cast<uint16_t>(i % models.size()));
    bodies.scales.push_back(1);
    bodies.phases.push_back(0);
  }
}

void Simulation::State::place_people() {
  for (const Person& person : spawned.people) {
    const std::shared_ptr<const Model>& body = scene.groups[person.group].body;
    bodies.types.push_back(kinds.of_group[person.group]);
    bodies.scales.push_back(static_cast<float>(person.height_m / double{body->height_m}));
    bodies.phases.push_back(static_cast<float>(person.phase));
    bodies.styles.push_back(person.style);
    rises_m.push_back(double{body->root_above_ground_m() * bodies.scales.back()});
  }
}

void Simulation::State::place_bodies() {
  if (box)
    place_parts();
  else
    place_people();
  speeds_mps.resize(avatars);
  bodies.gait_mps.assign(avatars, kNotComeIn);
  if (scene.planted_feet) bodies.resize_steps(avatars);
  if (!box) bodies.looks_rad = crowd.looks_rad();
  bodies.roots.resize(avatars);
  for (size_t i = 0; i < scene.obstacles.size(); ++i) {
    const SinCos turn = sin_cos(scene.obstacles[i].heading_rad);
    bodies.types.push_back(static_cast<uint16_t>(models.size() + i));
    bodies.scales.push_back(1);
    bodies.roots.push_back({scene.obstacles[i].centre_m, turned_to({turn.cos, turn.sin})});
  }
  for (uint32_t id = 0; id < bodies.types.size(); ++id) ids.push_back(id);
  if (!crowd.traffic().is_open()) return;
  there_ids.reserve(ids.size());
  there.types.reserve(ids.size());
  there.scales.reserve(ids.size());
  there.roots.reserve(ids.size());
}

void Simulation::State::place_driven() {
  is_driven_kind.assign(models.size(), false);
  if (box) return;
  for (uint32_t id = 0; id < avatars; ++id) {
    const Person& person = spawned.people[id];
    if (scene.groups[person.group].driven.empty()) continue;
    const Eigen::Vector2d& at = person.position_m;
    is_driven_kind[bodies.types[id]] = true;
    driven.add(id, models[bodies.types[id]]->kinematics,
               {{at.x(), at.y(), rises_m[id]}, turned_to(person.heading)});
  }
  if (driven.empty()) return;
  bodies.held_rows.assign(avatars, nullptr);
  driven.hold(bodies.held_rows);
  driven.lead(crowd);
  for (const Group& group : scene.groups)
    if (!group.driven.empty())
      spawned.notes.push_back(fmt::format(
          "group '{}' is driven by what comes on LCM channel {}: the events of this run "
          "depend on that, too",
          group.name, group.driven));
}

void Simulation::State::describe_run() {
  const auto count = static_cast<ptrdiff_t>(avatars);
  info.scene = &scene;
  identify_run(scene, options, info);
  info.step_s = scene.step_s;
  info.models = models;
  info.model_of_avatar.assign(bodies.types.begin(), bodies.types.begin() + count);
  info.scale_of_avatar.assign(bodies.scales.begin(), bodies.scales.begin() + count);
  if (box) {
    info.groups = {"part"};
    info.group_of_avatar.assign(avatars, 0);
  }
  for (const Group& group : scene.groups) info.groups.push_back(group.name);
  for (const Person& person : spawned.people)
    info.group_of_avatar.push_back(static_cast<uint16_t>(person.group));
  info.drive_channels.resize(info.groups.size());
  for (size_t g = 0; g < scene.groups.size(); ++g) info.drive_channels[g] = scene.groups[g].driven;
  info.part_volume = scene.part_volume;
  info.exact = scene.exact;
}

void Simulation::State::cut_blocks() {
  posture_offsets.push_back(0);
  for (uint32_t id = 0; id < avatars; ++id) {
    const bool continues = !blocks.empty() && blocks.back().count < kBlock &&
                           bodies.types[blocks.back().first] == bodies.types[id];
    if (!continues) blocks.push_back({id, 0});
    ++blocks.back().count;
    const auto columns = static_cast<size_t>(posing.column_count(bodies.types[id]));
    posture_offsets.push_back(posture_offsets.back() + columns);
  }
  if (options.postures) postures.resize(posture_offsets.back());
}

void Simulation::State::move() {
  if (box)
    box->step();
  else
    crowd.step();
  driven.lead(crowd);
}

void Simulation::State::update_parts() {
  for (size_t i = 0; i < avatars; ++i) {
    bodies.roots[i] = {box->positions_m()[i], box->orientations()[i].cast<float>()};
    speeds_mps[i] = static_cast<float>(box->velocities_mps()[i].norm());
  }
}

void Simulation::State::update_bodies() {
  if (box) return update_parts();
  const bool moved = frames > 0;
  workers.for_blocks(static_cast<int>(blocks.size()), [&](int index, int) {
    const Block& block = blocks[static_cast<size_t>(index)];
    std::array<WalkNow, WalkChunk::kRoom> walk;
    const uint32_t end = block.first + block.count;
    if (!scene.planted_feet) {
      for (uint32_t id = block.first; id < end; ++id)
        if (move_root(id).is_present)
          glide_on(posing, speeds_mps[id], moved ? crowd.walked_m()[id] : 0, id, bodies);
      return;
    }
    for (uint32_t first = block.first; first < end; first += WalkChunk::kRoom) {
      const size_t count = std::min<size_t>(WalkChunk::kRoom, end - first);
      for (size_t i = 0; i < count; ++i) walk[i] = move_root(first + static_cast<uint32_t>(i));
      walk_on(posing, {walk.data(), count}, scene.step_s, first, simd, bodies);
    }
  });
}

/// The root to where steering has the avatar.
WalkNow Simulation::State::move_root(uint32_t id) {
  RootPose& root = bodies.roots[id];
  const Eigen::Vector2d &position = crowd.positions_m()[id], &heading = crowd.headings()[id],
                        &velocity = crowd.velocities_mps()[id];
  // Whoever has left keeps the last place and posture.
  const bool is_present = crowd.journeys().is_present(id);
  const WalkNow walk = {root, static_cast<float>(velocity.dot(heading)), is_present};
  root.position_m = {position.x(), position.y(), rises_m[id]};
  root.world_from_root = turned_to(heading);
  if (is_present) speeds_mps[id] = static_cast<float>(velocity.norm());
  return walk;
}

void Simulation::State::update_postures() {
  workers.for_blocks(static_cast<int>(blocks.size()), [&](int index, int) {
    const Block& block = blocks[static_cast<size_t>(index)];
    const size_t begin = posture_offsets[block.first];
    const size_t end = posture_offsets[block.first + block.count];
    posing.postures(block.first, block.count, {postures.data() + begin, end - begin});
  });
  posing.use_rows(postures, posture_offsets);
}

/// What culling sees: everybody, or those who are in the scene now and the obstacles.
BodiesView Simulation::State::bodies_there() {
  if (!crowd.traffic().is_open()) return {ids, bodies.types, bodies.scales, bodies.roots};
  const std::span<const uint8_t> present = crowd.traffic().present();
  there_ids.clear();
  there.types.clear();
  there.scales.clear();
  there.roots.clear();
  for (uint32_t id = 0; id < ids.size(); ++id) {
    if (id < avatars && present[id] == 0) continue;
    there_ids.push_back(id);
    there.types.push_back(bodies.types[id]);
    there.scales.push_back(bodies.scales[id]);
    there.roots.push_back(bodies.roots[id]);
  }
  posing.use_bodies(there_ids);
  return {there_ids, there.types, there.scales, there.roots};
}

/// Stages of the culling pass overlap over threads: each gets its share of the pass's wall time.
void Simulation::State::split_times(double steering_ns, double postures_ns) {
  const CullingCounters& counters = culler->counters();
  const Posing::Times posed = posing.take_times();
  const auto sum = [](const StageCounters& stage) { return stage.update_ns + stage.test_ns; };
  const double avatar_ns = sum(counters.avatar) + sum(counters.body_box);
  const double part_ns = sum(counters.box) + sum(counters.part);
  const double exact_ns = sum(counters.exact);
  const double pose_ns = posed.gait_ns + posed.kinematics_ns;
  const double total_ns = avatar_ns + part_ns + exact_ns + pose_ns;
  const double pass_ns = std::max(0.0, counters.wall_ns - counters.events_ns);
  const double share = total_ns > 0 ? pass_ns / total_ns : 0;
  times[Stage::kSteering] = steering_ns;
  times[Stage::kGait] = postures_ns + share * posed.gait_ns;
  times[Stage::kKinematics] = share * posed.kinematics_ns;
  times[Stage::kAvatarCull] = share * avatar_ns;
  times[Stage::kPartCull] = share * part_ns;
  times[Stage::kExact] = share * exact_ns;
  times[Stage::kEvents] = counters.events_ns;
}

void Simulation::State::fill_frame() {
  frame.number = frames;
  frame.utime_us =
      static_cast<int64_t>(std::llround(static_cast<double>(frames) * scene.step_s * 1e6));
  frame.roots = {bodies.roots.data(), avatars};
  frame.speeds_mps = speeds_mps;
  frame.postures = postures;
  frame.posture_offsets = posture_offsets;
  frame.pairs = culler->pairs();
  frame.events = culler->events();
  if (crowd.traffic().is_open()) frame.present = crowd.traffic().present();
  frame.levels = culler->levels();
  frame.persisting = culler->persisting();
  frame.hash = culler->hash();
  frame.counters = &culler->counters();
  frame.times = &times;
  for (const PairEvent& event : frame.events) ++(event.kind == EventKind::kBegin ? begins : ends);
}

Simulation::Simulation(Scene scene, const SimulationOptions& options)
    : state_(std::make_unique<State>(std::move(scene), options)) {}
Simulation::~Simulation() = default;

const RunInfo& Simulation::info() const { return state_->info; }
const Scene& Simulation::scene() const { return state_->scene; }
const std::vector<std::string>& Simulation::notes() const { return state_->spawned.notes; }
const SteeringCounters& Simulation::steering() const { return state_->crowd.counters(); }
const TrafficCounters& Simulation::traffic() const { return state_->crowd.traffic().counters(); }
std::vector<Stranding> Simulation::strandings() const {
  return state_->crowd.journeys().strandings(state_->crowd.positions_m());
}
const BodyStates& Simulation::bodies() const { return state_->bodies; }
FrameTimes& Simulation::times() { return state_->times; }

int Simulation::unplaced() const {
  int total = 0;
  for (const int count : state_->spawned.unplaced) total += count;
  return total;
}

const Frame& Simulation::step() {
  State& s = *state_;
  const auto start = Clock::now();
  if (s.frames > 0) s.move();
  const double steering_ns = nanoseconds_since(start);
  const auto before_gait = Clock::now();
  s.update_bodies();
  s.driven.place(s.bodies.roots);
  if (s.options.postures) s.update_postures();
  const double postures_ns = nanoseconds_since(before_gait);
  if (s.options.culling) s.culler->step(s.bodies_there(), s.posing);
  s.split_times(steering_ns, postures_ns);
  s.fill_frame();
  ++s.frames;
  s.times.frame_ns = nanoseconds_since(start);
  return s.frame;
}

int Simulation::drive(uint32_t avatar, const DrivenPose& pose) {
  return state_->driven.drive(avatar, pose, state_->scene.ground);
}

RunEnd Simulation::finish() {
  State& s = *state_;
  s.culler->finish();
  for (const PairEvent& event : s.culler->events())
    ++(event.kind == EventKind::kBegin ? s.begins : s.ends);
  RunEnd end;
  end.frames = s.frames;
  end.utime_us = s.frame.utime_us;
  end.events = s.culler->events();
  end.begins = s.begins;
  end.ends = s.ends;
  end.hash = s.culler->hash();
  return end;
}

int64_t Simulation::next_frame() const { return state_->frames; }

std::vector<uint8_t> Simulation::saved() {
  Archive out;
  state_->archive(out);
  return out.bytes();
}

void Simulation::resume(std::span<const uint8_t> bytes, const std::string& name) {
  assert(state_->frames == 0);
  Archive in(bytes, name);
  state_->archive(in);
  in.expect_end();
  if (state_->frames < 1) in.refuse("a frame number above 0", std::to_string(state_->frames));
  const std::span<const PairKey> touching = state_->culler->pairs();
  const std::span<const uint8_t> levels = state_->culler->levels();
  state_->info.resumed = {state_->frames - 1,
                          state_->frame.utime_us,
                          {touching.begin(), touching.end()},
                          {levels.begin(), levels.end()},
                          state_->culler->hash()};
}

}  // namespace throng
