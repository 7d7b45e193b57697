#include "scenes/run/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include "avatars/model/describe.h"
#include "avatars/stepping/standing.h"
#include "base/checksum.h"
#include "base/errors.h"
#include "base/portable_math.h"
#include "base/stopwatch.h"
#include "crowd/navigation/footprints.h"
#include "culling/strategies/paper_culler.h"
#include "scenes/motion/body_blocks.h"
#include "scenes/motion/external_avatars.h"
#include "scenes/motion/walk.h"
#include "scenes/run/body_avoidance_stage.h"
#include "scenes/run/body_kinds.h"
#include "scenes/run/body_tables.h"
#include "scenes/run/crowd_change.h"
#include "scenes/run/named_bodies.h"
#include "scenes/run/posing.h"
#include "scenes/separation/separation_rule.h"

namespace throng {

namespace {

/// Maximum number of changes of the crowd between two steps that a checkpoint holds.
constexpr size_t kMaxChanges = 10'000'000;

uint64_t random_instance() {
  std::random_device device;
  return (uint64_t{device()} << 32) | device();
}

/// Sets run id, instance and the fields that options determine. `motion_hash`:
/// MotionSource::content_hash().
void identify_run(const Scene& scene, const SimulationOptions& options, uint64_t motion_hash,
                  RunInfo& info) {
  // Threads, SIMD, pair search and outputs are omitted: they change no frame.
  Hasher name;
  name.add("throng run 1").add(scene.content_hash);
  if (motion_hash != 0) name.add("world").add(motion_hash);
  const CullerOptions& culler = options.culler;
  if (culler.budget_ms) name.add("budget, ms").add(*culler.budget_ms);
  if (culler.budget_tests) name.add("budget, tests").add(*culler.budget_tests);
  if (options.strategy != Strategy::kPipeline) name.add("strategy").add(name_of(options.strategy));
  if (!options.culling) name.add("no culling");
  info.run_id = name.value();
  info.instance = random_instance();
  info.culler = options.culler;
  info.strategy = options.strategy;
  info.culling = options.culling;
}

/// System clock, comparable between programs on this machine.
int64_t since_1970_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

Scene with_bodies(Scene scene, BodyTables& tables) {
  for (Group& group : scene.groups) {
    if (group.body == nullptr) group.body = tables.model(group.model);
    keep_own_size(group);
  }
  if (scene.box && scene.box->body == nullptr) scene.box->body = tables.model(scene.box->model);
  scene.content_hash = content_hash_of(scene);
  return scene;
}

/// Initial state of avatars and obstacles. Adds externally controlled avatars to `external`, whose
/// rows it refers to.
BodyStates bodies_of(MotionSource& motion, const Scene& scene, ExternalAvatars& external) {
  BodyStates bodies;
  motion.place(bodies);
  const size_t avatars = bodies.types.size();
  bodies.gait_mps.assign(avatars, kNotEntered);
  if (scene.planted_feet) bodies.resize_steps(avatars);
  if (scene.planted_feet && scene.body_avoidance) bodies.standing_seed = scene.seed;
  motion.add_external(external);
  if (!external.empty()) {
    bodies.external_rows.resize(avatars, nullptr);
    external.bind_rows(bodies.external_rows);
  }
  bodies.roots.resize(avatars);
  for (size_t i = 0; i < scene.obstacles.size(); ++i) {
    const SinCos turn = sin_cos(scene.obstacles[i].heading_rad);
    bodies.types.push_back(static_cast<uint16_t>(motion.models().size() + i));
    bodies.scales.push_back(1);
    bodies.roots.push_back({scene.obstacles[i].centre_m, rotation_to({turn.cos, turn.sin})});
  }
  return bodies;
}

SimulationOptions with_tables(SimulationOptions options) {
  if (options.tables == nullptr) options.tables = std::make_shared<BodyTables>();
  return options;
}

SimulationOptions with_scene(SimulationOptions options, const Scene& scene) {
  require_valid_separation(scene);
  options.culler.part_volume = scene.part_volume.fallback;
  options.culler.exact = scene.exact;
  options.culler.check_spheres = false;  // posing and spheres have the same source
  options.culler.proximity = {static_cast<float>(scene.proximity_m),
                              static_cast<float>(scene.closest_parts_m), scene.step_s,
                              scene.contact_points};
  return options;
}

std::vector<ModelUse> uses_of(size_t models, const Scene& scene, const BodyStates& bodies) {
  const PostureKind walking = scene.planted_feet ? PostureKind::kStepping : PostureKind::kTable;
  std::vector<ModelUse> uses(models, ModelUse{{}, walking});
  for (size_t i = 0; i < bodies.styles.size(); ++i)
    uses[bodies.types[i]].styles.set(static_cast<size_t>(bodies.styles[i]));
  for (size_t i = 0; i < bodies.external_rows.size(); ++i)
    if (bodies.external_rows[i] != nullptr) uses[bodies.types[i]].postures = PostureKind::kExternal;
  return uses;
}

RootSphere external_rows_sphere(const MotionSource& motion, size_t model) {
  const std::optional<RootSphere> known = motion.external_rows_sphere(model);
  return known ? *known : any_posture_sphere(*motion.models()[model]);
}

}  // namespace

/// PresentBodies selects the bodies that culling sees: those that are in the scene. Ids stay.
class PresentBodies {
 public:
  explicit PresentBodies(size_t bodies);

  /// `present`: one per avatar, or empty if all are present; obstacles always are. The view is
  /// valid until the next call and as long as `bodies`.
  BodiesView view(const BodyStates& bodies, std::span<const uint8_t> present);

  std::span<const uint32_t> chosen() const { return chosen_; }

 private:
  std::vector<uint32_t> ids_;
  std::vector<uint32_t> chosen_;
  std::vector<uint16_t> types_;
  std::vector<float> scales_;
  std::vector<RootPose> roots_;
};

PresentBodies::PresentBodies(size_t bodies) : ids_(bodies) {
  std::iota(ids_.begin(), ids_.end(), 0u);
}

BodiesView PresentBodies::view(const BodyStates& bodies, std::span<const uint8_t> present) {
  if (present.empty()) return {ids_, bodies.types, bodies.scales, bodies.roots};
  chosen_.clear();
  types_.clear();
  scales_.clear();
  roots_.clear();
  // Reserves once; later steps do not allocate.
  chosen_.reserve(ids_.size());
  types_.reserve(ids_.size());
  scales_.reserve(ids_.size());
  roots_.reserve(ids_.size());
  for (uint32_t id = 0; id < ids_.size(); ++id) {
    if (id < present.size() && present[id] == 0) continue;
    chosen_.push_back(id);
    types_.push_back(bodies.types[id]);
    scales_.push_back(bodies.scales[id]);
    roots_.push_back(bodies.roots[id]);
  }
  return {chosen_, types_, scales_, roots_};
}

struct Simulation::State {
  State(Scene scene_in, const SimulationOptions& options_in);

  void archive(Archive& a);
  void describe_run();
  void gather_notes();
  void cut_blocks();
  std::vector<std::shared_ptr<const BodyType>> types() const;
  bool is_present(uint32_t avatar) const {
    const std::span<const uint8_t> present = motion->present();
    return avatar >= present.size() || present[avatar] != 0;
  }
  void update_postures();
  void split_times(double steering_ns, double postures_ns);
  void fill_frame();
  void require_in_frame(uint32_t body, const char* where) const;
  std::vector<std::string> part_names(uint32_t body) const;
  BodyInPose posed(uint32_t body, std::span<const uint8_t> parts,
                   std::vector<PartPose>& poses) const;

  Scene scene;
  SimulationOptions options;
  Workers workers;
  std::unique_ptr<MotionSource> motion;
  const std::vector<std::shared_ptr<const Model>>& models;
  ExternalAvatars external;
  BodyStates bodies;
  size_t avatars;
  std::vector<float> speeds_mps;
  std::vector<ModelUse> uses;
  Posing posing;
  PresentBodies present_bodies;
  std::vector<BodyBlock> blocks;
  std::vector<float> postures;
  std::vector<size_t> posture_offsets;
  std::unique_ptr<BodyAvoidanceStage> body_avoidance;
  std::vector<std::shared_ptr<const BodyType>> body_types;
  std::unique_ptr<AnyCuller> culler;
  RunInfo info;
  std::vector<std::string> notes;
  std::vector<CrowdChange> new_changes;  ///< since the latest step
  std::vector<CrowdChange> changes;      ///< those of the latest step
  std::vector<uint8_t> kept_present;     ///< presence in the latest frame, after a change
  std::optional<PartTally> part_tally;
  Frame frame;
  FrameTimes times;
  int64_t frames = 0;
  uint64_t begins = 0;
  uint64_t ends = 0;
};

Simulation::State::State(Scene scene_in, const SimulationOptions& options_in)
    : scene(with_bodies(std::move(scene_in), *options_in.tables)),
      options(with_scene(options_in, scene)),
      workers(options.threads),
      motion((options.motion ? options.motion : make_motion)(scene, options.culler.simd, workers)),
      models(motion->models()),
      bodies(bodies_of(*motion, scene, external)),
      avatars(bodies.phases.size()),
      speeds_mps(avatars),
      uses(uses_of(models.size(), scene, bodies)),
      posing(models, uses, bodies, *options.tables, workers),
      present_bodies(bodies.types.size()) {
  describe_run();
  cut_blocks();
  motion->prepare(posing, bodies);
  motion->apply_external(external);
  if (scene.body_avoidance && scene.planted_feet) {
    bodies.avoidance.resize(avatars);
    for (size_t id = 0; id < avatars; ++id)
      bodies.standing.push_back(standing_posture(scene.seed, id));
    body_avoidance = std::make_unique<BodyAvoidanceStage>(scene, posing, bodies, avatars,
                                                          options.culler.simd, workers);
  }
  options.culler.filter = filter_of(scene, info);
  body_types = types();
  culler = make_culler(body_types, options.strategy, options.culler, workers);
  options.tables.reset();  // frees tables that no other run shares
  gather_notes();
}

std::vector<std::shared_ptr<const BodyType>> Simulation::State::types() const {
  require_parts(scene.part_volume, models);
  std::vector<std::shared_ptr<const BodyType>> all;
  for (size_t i = 0; i < models.size(); ++i) {
    const bool is_external = uses[i].postures == PostureKind::kExternal;
    all.push_back(options.tables->body_type(
        models[i], is_external ? external_rows_sphere(*motion, i) : posing.sphere(i),
        scene.part_volume));
  }
  for (const Obstacle& obstacle : scene.obstacles) all.push_back(obstacle_type(obstacle));
  return all;
}

void Simulation::State::archive(Archive& a) {
  a(frames, begins, ends, frame.utime_us, bodies.phases, bodies.gait_mps, bodies.standing_time_s);
  for (std::vector<float>& numbers : bodies.feet) a(numbers);
  for (std::vector<float>& numbers : bodies.gait_rates) a(numbers);
  for (size_t i = 0; i < avatars; ++i)
    a(bodies.roots[i].position_m, bodies.roots[i].world_from_root, speeds_mps[i]);
  for (const float speed : bodies.gait_mps)
    if (!(speed >= kNotEntered && speed < 1000)) a.reject("a gait speed below 1000 m/s", "another");
  for (const float standing_time_s : bodies.standing_time_s)
    if (!(standing_time_s >= 0 && standing_time_s <= kMaxStandingTime_s))
      a.reject("a possible standing time", "another");
  constexpr float kFarFoot_m = 10;
  for (const std::vector<float>& numbers : bodies.feet)
    for (const float number : numbers)
      if (!(std::abs(number) < kFarFoot_m))
        a.reject("feet within 10 m of their body", std::to_string(number) + " m");
  constexpr float kMaxMomentum = 1000;
  for (const std::vector<float>& numbers : bodies.gait_rates)
    for (const float number : numbers)
      if (!(std::abs(number) < kMaxMomentum))
        a.reject("rates of feet and hips below 1000", std::to_string(number));
  for (const float phase : bodies.phases)
    if (!(phase >= 0 && phase <= 1)) a.reject("a gait phase from 0 to 1", "another");
  a.resized(new_changes, kMaxChanges);
  motion->archive(a);
  external.archive(a);
  if (body_avoidance) body_avoidance->archive(a, bodies);
  culler->archive(a);
}

void Simulation::State::describe_run() {
  const auto count = static_cast<ptrdiff_t>(avatars);
  info.scene = &scene;
  identify_run(scene, options, motion->content_hash(), info);
  info.step_s = scene.step_s;
  info.models = models;
  info.model_of_avatar.assign(bodies.types.begin(), bodies.types.begin() + count);
  info.scale_of_avatar.assign(bodies.scales.begin(), bodies.scales.begin() + count);
  motion->describe(info);
}

void Simulation::State::gather_notes() {
  notes = motion->notes();
  for (std::string& note : filter_notes(scene, info)) notes.push_back(std::move(note));
  for (std::string& note : notes_on(models)) notes.push_back(std::move(note));
}

void Simulation::State::cut_blocks() {
  blocks = blocks_of({bodies.types.data(), avatars});
  posture_offsets.push_back(0);
  for (size_t id = 0; id < avatars; ++id) {
    const auto columns = static_cast<size_t>(posing.column_count(bodies.types[id]));
    posture_offsets.push_back(posture_offsets.back() + columns);
  }
}

void Simulation::State::update_postures() {
  postures.resize(posture_offsets.back());
  workers.for_blocks(static_cast<int>(blocks.size()), [&](int index, int) {
    const BodyBlock& block = blocks[static_cast<size_t>(index)];
    const size_t begin = posture_offsets[block.first];
    const size_t end = posture_offsets[block.first + block.count];
    posing.postures(block.first, block.count, {postures.data() + begin, end - begin});
  });
  posing.use_rows(postures, posture_offsets);
}

/// Stages of the culling pass overlap on several threads; each gets its share of the wall time.
void Simulation::State::split_times(double steering_ns, double postures_ns) {
  const CullingCounters& counters = *culler->frame().counters;
  const Posing::Times posed = posing.take_times();
  const auto sum = [](const StageCounters& stage) { return stage.update_ns + stage.test_ns; };
  const double broad_phase_ns = sum(counters.body_sphere) + sum(counters.body_box);
  const double mid_phase_ns = sum(counters.part_box) + sum(counters.part_volume);
  const double narrow_phase_ns = sum(counters.triangles);
  const double pose_ns = posed.gait_ns + posed.kinematics_ns;
  const double total_ns = broad_phase_ns + mid_phase_ns + narrow_phase_ns + pose_ns;
  const double proximity_ns = counters.proximity.update_ns + counters.proximity.test_ns;
  const double pass_ns = std::max(0.0, counters.wall_ns - counters.events_ns - proximity_ns);
  const double share = total_ns > 0 ? pass_ns / total_ns : 0;
  times[Stage::kSteering] = steering_ns;
  times[Stage::kGait] = postures_ns + share * posed.gait_ns;
  times[Stage::kKinematics] = share * posed.kinematics_ns;
  times[Stage::kBroadPhase] = share * broad_phase_ns;
  times[Stage::kMidPhase] = share * mid_phase_ns;
  times[Stage::kNarrowPhase] = share * narrow_phase_ns;
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
  frame.present = motion->present();
  frame.changes = changes;
  static_cast<CullingResult&>(frame) = culler->frame();
  frame.times = &times;
  for (const PairEvent& event : frame.events) ++(event.kind == EventKind::kBegin ? begins : ends);
}

void Simulation::State::require_in_frame(uint32_t body, const char* where) const {
  if (frame.times == nullptr) throw InputError("distance", "a step before it", "none");
  if (body >= bodies.types.size())
    throw InputError(where, fmt::format("a body number from 0 to {}", bodies.types.size() - 1),
                     fmt::format("{}", body));
  if (body < frame.present.size() && frame.present[body] == 0)
    throw InputError(where, fmt::format("a body in the scene in frame {}", frame.number),
                     fmt::format("avatar {}, which is not", body));
}

std::vector<std::string> Simulation::State::part_names(uint32_t body) const {
  if (body >= avatars) return {scene.obstacles[body - avatars].name};
  std::vector<std::string> names;
  for (const Part& part : models[bodies.types[body]]->parts) names.push_back(part.name);
  return names;
}

BodyInPose Simulation::State::posed(uint32_t body, std::span<const uint8_t> parts,
                                    std::vector<PartPose>& poses) const {
  poses.resize(body_types[bodies.types[body]]->parts().size());
  posing.pose_of(body, poses);
  return {body, bodies.types[body], bodies.scales[body], bodies.roots[body].position_m, poses,
          parts};
}

Simulation::Simulation(Scene scene, const SimulationOptions& options)
    : state_(std::make_unique<State>(std::move(scene), with_tables(options))) {}
Simulation::~Simulation() = default;

const RunInfo& Simulation::info() const { return state_->info; }
const Scene& Simulation::scene() const { return state_->scene; }
const std::vector<std::string>& Simulation::notes() const { return state_->notes; }
int Simulation::unplaced() const { return state_->motion->unplaced(); }
const SteeringCounters& Simulation::steering() const { return state_->motion->steering(); }
const PopulationCounters& Simulation::population() const { return state_->motion->population(); }
std::vector<Stranding> Simulation::strandings() const { return state_->motion->strandings(); }
bool Simulation::is_present(uint32_t avatar) const { return state_->is_present(avatar); }
const BodyStates& Simulation::bodies() const { return state_->bodies; }
FrameTimes& Simulation::times() { return state_->times; }

void Simulation::serve(std::span<Sink* const> sinks) {
  State& s = *state_;
  s.options.postures = std::any_of(sinks.begin(), sinks.end(),
                                   [](const Sink* sink) { return sink->needs().postures; });
  if (s.options.postures) return;
  s.postures.clear();
  s.posing.use_rows({}, {});
}

const Frame& Simulation::step() {
  State& s = *state_;
  const Stopwatch watch;
  if (!s.changes.empty() || !s.new_changes.empty()) {
    s.changes = std::move(s.new_changes);
    s.new_changes.clear();
    s.kept_present.clear();
  }
  if (s.frames > 0) {
    s.motion->step();
    s.motion->apply_external(s.external);
    s.external.stop_walking();
  }
  const double steering_ns = watch.ns();
  const Stopwatch gait_watch;
  s.external.bind_rows(s.bodies.external_rows);
  s.bodies.now_s = static_cast<double>(s.frames) * s.scene.step_s;
  s.motion->update(s.posing, s.bodies, s.speeds_mps);
  s.external.place(s.bodies.roots);
  const Stopwatch avoidance_watch;
  if (s.body_avoidance) s.body_avoidance->step(s.motion->expected(), s.bodies);
  s.times[Stage::kBodyAvoidance] = avoidance_watch.ns();
  if (s.options.postures) s.update_postures();
  const double postures_ns = gait_watch.ns() - s.times[Stage::kBodyAvoidance];
  if (s.options.culling) {
    const BodiesView present_bodies = s.present_bodies.view(s.bodies, s.motion->present());
    s.posing.use_bodies(s.present_bodies.chosen());
    s.times.culling_began_ns = since_1970_ns();
    s.culler->step(present_bodies, s.posing);
  }
  s.split_times(steering_ns, postures_ns);
  s.fill_frame();
  ++s.frames;
  s.times.frame_ns = watch.ns();
  return s.frame;
}

uint32_t Simulation::add(const std::string& group, std::span<const AgentEntry> entries) {
  CrowdChange added{
      .kind = CrowdChange::Kind::kAdd, .group = group, .entries = {entries.begin(), entries.end()}};
  change(added);
  return added.ids.empty() ? 0 : added.ids.front();
}

void Simulation::remove(std::span<const uint32_t> ids) {
  CrowdChange removed{.kind = CrowdChange::Kind::kRemove, .ids = {ids.begin(), ids.end()}};
  change(removed);
}

void Simulation::set_goal(std::span<const uint32_t> ids, const std::string& goal) {
  CrowdChange redirected{
      .kind = CrowdChange::Kind::kSetGoal, .ids = {ids.begin(), ids.end()}, .goal = goal};
  change(redirected);
}

void Simulation::set_desired_speed(std::span<const uint32_t> ids,
                                   std::span<const double> desired_mps) {
  CrowdChange paced{.kind = CrowdChange::Kind::kSetDesiredSpeed,
                    .ids = {ids.begin(), ids.end()},
                    .desired_mps = {desired_mps.begin(), desired_mps.end()}};
  change(paced);
}

void Simulation::change(CrowdChange& change) {
  State& s = *state_;
  Crowd* crowd = s.motion->crowd();
  if (crowd == nullptr)
    throw InputError(s.scene.name, "a scene with a crowd whose people can be changed",
                     "one whose motion is recorded, or a box of parts");
  if (s.kept_present.empty()) {  // the latest frame stays as it is
    s.kept_present.assign(s.frame.present.begin(), s.frame.present.end());
    s.frame.present = s.kept_present;
  }
  apply(change, s.scene, *crowd, s.external);
  if (!change.ids.empty()) s.new_changes.push_back(change);
}

int Simulation::set_pose(uint32_t avatar, const ExternalPose& pose) {
  if (!state_->is_present(avatar)) return -1;
  return state_->external.set_pose(avatar, pose, state_->scene.ground);
}

int Simulation::walk_to(uint32_t avatar, const Eigen::Vector2d& position_m,
                        const std::optional<Eigen::Vector2d>& heading,
                        const std::optional<Eigen::Vector2d>& velocity_mps) {
  State& s = *state_;
  if (!can_walk(avatar)) return -1;
  ExternalPose pose = *s.external.pose(avatar);
  pose.walks = true;
  pose.root.position_m.head<2>() = position_m;
  const Eigen::Vector2d from = s.motion->crowd()->positions_m()[avatar];
  Eigen::Vector2d path_mps = (position_m - from) / s.scene.step_s;
  if (path_mps.norm() > kMaxExternalSpeed_mps) path_mps.setZero();  // a jump
  pose.velocity_mps = velocity_mps.value_or(path_mps);
  Eigen::Vector2d facing = heading.value_or(pose.velocity_mps);
  // Below this speed the direction of a path is noise.
  constexpr double kMinTurning_mps = 0.1;
  if (heading || facing.norm() > kMinTurning_mps)
    pose.root.world_from_root = rotation_to(facing.normalized());
  return s.external.set_pose(avatar, pose, s.scene.ground);
}

bool Simulation::can_walk(uint32_t avatar) const {
  const State& s = *state_;
  return s.external.pose(avatar) != nullptr && s.is_present(avatar) &&
         s.posing.gait_of(avatar).has_legs();
}

const ExternalPose* Simulation::external_pose(uint32_t avatar) const {
  return state_->external.pose(avatar);
}

RunEnd Simulation::finish() {
  State& s = *state_;
  s.culler->finish();
  const CullingResult last = s.culler->frame();
  for (const PairEvent& event : last.events)
    ++(event.kind == EventKind::kBegin ? s.begins : s.ends);
  RunEnd end;
  end.frames = s.frames;
  end.utime_us = s.frame.utime_us;
  end.events = last.events;
  end.begins = s.begins;
  end.ends = s.ends;
  end.hash = last.hash;
  if (s.options.culler.by_part) s.part_tally = s.culler->part_tally();
  end.by_part = s.part_tally ? &*s.part_tally : nullptr;
  end.proximity_hash = last.proximity_hash;
  return end;
}

PartDistance Simulation::distance(uint32_t a, const PartChoice& part_a, uint32_t b,
                                  const PartChoice& part_b) const {
  const State& s = *state_;
  s.require_in_frame(a, "a");
  s.require_in_frame(b, "b");
  if (a == b) throw InputError("b", "another body than a", fmt::format("{}", b));
  const std::vector<uint8_t> parts_a = chosen_parts(part_a, s.part_names(a), "part_a"),
                             parts_b = chosen_parts(part_b, s.part_names(b), "part_b");
  std::vector<PartPose> poses_a, poses_b;
  return part_distance(s.body_types, s.posed(a, parts_a, poses_a), s.posed(b, parts_b, poses_b));
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
  if (state_->frames < 1) in.reject("a frame number above 0", std::to_string(state_->frames));
  const CullingResult last = state_->culler->frame();
  state_->info.resumed = {state_->frames - 1,
                          state_->frame.utime_us,
                          {last.pairs.begin(), last.pairs.end()},
                          {last.levels.begin(), last.levels.end()},
                          last.hash};
}

}  // namespace throng
