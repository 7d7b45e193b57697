#include "culling/culler.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <numeric>
#include <utility>

#include "base/errors.h"
#include "culling/broad_phase.h"
#include "culling/deadline.h"
#include "culling/fitted.h"
#include "culling/part_stage.h"
#include "culling/slots.h"
#include "culling/stopwatch.h"

namespace throng {
namespace {

constexpr size_t kPairsPerTask =
    8192;                             // sphere pairs a task of the narrow phase: fills the buckets
constexpr size_t kSortBodies = 4096;  // bodies a task when keys are sorted

}  // namespace

struct Culler::State {
  State(std::vector<std::shared_ptr<const BodyType>> body_types, const CullerOptions& opts,
        Workers& pool);

  void plan_tasks();
  PartStageFrame part_stage_frame();
  void refine();
  void refine_by_urgency(std::chrono::steady_clock::time_point start, const BodiesView& bodies,
                         const PoseSource& poses);
  void sort_keys(size_t bodies);
  void take_events(const BodiesView& bodies);
  void hash_events();
  void sum_counters();
  uint64_t times_grown() const;

  std::vector<std::shared_ptr<const BodyType>> types;
  CullerOptions options;
  Workers& workers;
  const Kernels& kernels;

  // By type, or by shape: what kernels read instead of BodyType.
  std::vector<uint16_t> type_parts, type_first_shape, shape_type;

  Slots slots;
  BroadPhase broad;
  std::vector<PartStage> stages;  // one a worker

  /// Consecutive blocks of sphere pairs, and the keys that they yield.
  struct Task {
    size_t first = 0, end = 0;
    GrowBuffer<PairKey> keys;
    size_t count = 0;
  };
  std::vector<Task> tasks;
  size_t task_count = 0;

  GrowBuffer<PairKey> sorted;
  GrowBuffer<uint32_t> start_of_body;
  size_t sorted_count = 0;
  PairEvents events;
  std::unique_ptr<Deadline> deadline;  // null without one
  CullingCounters counters;
  uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a
  uint64_t frame = 0;
};

Culler::State::State(std::vector<std::shared_ptr<const BodyType>> body_types,
                     const CullerOptions& opts, Workers& pool)
    : types(std::move(body_types)),
      options(opts),
      workers(pool),
      kernels(kernels_for(opts.simd)),
      slots(types, kernels, pool),
      broad(types, kernels, pool, opts.pair_search),
      stages(static_cast<size_t>(pool.threads())) {
  size_t shapes = 0;
  for (size_t type = 0; type < types.size(); ++type) {
    if (options.exact && !types[type]->has_triangles())
      throw InputError("exact contacts", "triangles in every part", "a point cloud");
    const size_t parts = static_cast<size_t>(types[type]->part_count());
    type_parts.push_back(static_cast<uint16_t>(parts));
    type_first_shape.push_back(static_cast<uint16_t>(std::min(shapes, size_t{kMaxBucketShapes})));
    shapes += parts;
    while (shape_type.size() < std::min(shapes, size_t{kMaxBucketShapes}))
      shape_type.push_back(static_cast<uint16_t>(type));
  }
  if (options.deadline_ms || options.deadline_tests)
    deadline = std::make_unique<Deadline>(options, workers);
}

/// Groups the blocks of the broad phase into tasks of about kPairsPerTask pairs.
void Culler::State::plan_tasks() {
  task_count = 0;
  size_t pairs = kPairsPerTask;
  for (size_t block = 0; block < broad.block_count(); ++block) {
    if (pairs >= kPairsPerTask) {
      if (tasks.size() == task_count) tasks.emplace_back();
      tasks[task_count].first = block;
      tasks[task_count].count = 0;
      ++task_count;
      pairs = 0;
    }
    tasks[task_count - 1].end = block + 1;
    pairs += broad.block(block).size();
  }
}

PartStageFrame Culler::State::part_stage_frame() {
  const BoxFrame boxes{slots.boxes(), type_parts.data(), type_first_shape.data(),
                       static_cast<uint32_t>(shape_type.size())};
  return {types, shape_type, type_first_shape,    slots.data(), slots.poses(),
          boxes, &kernels,   options.part_volume, options.exact};
}

void Culler::State::refine() {
  plan_tasks();
  for (PartStage& stage : stages) stage.clear_counters();
  const PartStageFrame shared = part_stage_frame();
  workers.for_blocks(static_cast<int>(task_count), [&](int index, int worker) {
    Task& task = tasks[static_cast<size_t>(index)];
    PartStage& stage = stages[static_cast<size_t>(worker)];
    stage.begin();
    for (size_t block = task.first; block < task.end; ++block)
      stage.add(shared, broad.block(block));
    stage.finish(shared, task.keys, task.count);
  });
  for (PartStage& stage : stages)
    for (const PartStage& other : stages) stage.reserve_like(other);
}

/// The narrow phase under a deadline: poses, refines and takes events by itself.
void Culler::State::refine_by_urgency(std::chrono::steady_clock::time_point start,
                                      const BodiesView& bodies, const PoseSource& poses) {
  deadline->refine(start, bodies, poses, broad, slots, part_stage_frame());
  sum_counters();
  Stopwatch watch;
  deadline->take_events(bodies, events);
  hash_events();
  counters.events_ns = watch.lap_ns();
  counters.levels = deadline->reported();
}

/// Keys by body a with a counting sort, then each body's few by comparison.
void Culler::State::sort_keys(size_t bodies) {
  start_of_body.resize(bodies + 2);
  std::fill_n(start_of_body.data(), bodies + 2, 0u);
  sorted_count = 0;
  for (size_t t = 0; t < task_count; ++t) {
    sorted_count += tasks[t].count;
    for (size_t i = 0; i < tasks[t].count; ++i) ++start_of_body[size_t{tasks[t].keys[i].a()} + 2];
  }
  std::partial_sum(start_of_body.data(), start_of_body.data() + bodies + 2, start_of_body.data());
  sorted.resize(sorted_count);
  for (size_t t = 0; t < task_count; ++t)
    for (size_t i = 0; i < tasks[t].count; ++i)
      sorted[start_of_body[size_t{tasks[t].keys[i].a()} + 1]++] = tasks[t].keys[i];
  workers.for_blocks(
      static_cast<int>((bodies + kSortBodies - 1) / kSortBodies), [&](int block, int) {
        const size_t first = static_cast<size_t>(block) * kSortBodies;
        for (size_t body = first; body < std::min(bodies, first + kSortBodies); ++body)
          std::sort(sorted.data() + start_of_body[body], sorted.data() + start_of_body[body + 1]);
      });
}

/// From body indices, which are this frame's, to ids, which last; both ascend together.
void Culler::State::take_events(const BodiesView& bodies) {
  for (size_t i = 0; i < sorted_count; ++i) {
    const PairKey key = sorted[i];
    sorted[i] = PairKey(bodies.ids[key.a()], bodies.ids[key.b()], key.part_a(), key.part_b());
  }
  events.advance({sorted.data(), sorted_count});
  hash_events();
}

void Culler::State::hash_events() {
  const auto mix = [this](uint64_t word) { hash = (hash ^ word) * 0x100000001b3ull; };
  const std::span<const PairEvent> all = events.events();
  for (const PairEvent& event : all) {
    mix(frame);
    mix(event.pair.bits());
    mix(static_cast<uint64_t>(event.kind));
    if (deadline) mix(deadline->event_levels()[static_cast<size_t>(&event - all.data())]);
  }
  ++frame;
}

void Culler::State::sum_counters() {
  PartStageCounters parts;
  for (const PartStage& stage : stages) parts.add(stage.counters());
  if (deadline) parts = deadline->counters();
  const Slots::Counters posed = slots.counters();
  counters.avatar = broad.counters();
  counters.body_box = parts.body_box;
  counters.body_box.volume = "aabb";
  counters.body_box.updates = posed.bodies;
  counters.box = parts.box;
  counters.box.volume = "aabb";
  counters.box.updates = posed.parts;
  counters.box.update_ns = posed.box_ns;
  counters.part = parts.part;
  counters.part.volume = name_of(options.part_volume);
  counters.part.updates += posed.parts;
  counters.part.update_ns += posed.pose_ns;
  counters.exact = parts.exact;
  counters.exact.volume = options.exact ? "triangles" : "off";
  counters.primitive_tests = parts.primitive_tests;
  counters.posed_bodies = posed.bodies;
  counters.pose_ns = posed.pose_ns;
}

uint64_t Culler::State::times_grown() const {
  uint64_t sum = slots.times_grown() + broad.times_grown() + sorted.times_grown() +
                 start_of_body.times_grown() + events.times_grown();
  for (const PartStage& stage : stages) sum += stage.times_grown();
  for (const Task& task : tasks) sum += task.keys.times_grown();
  if (deadline) sum += deadline->times_grown();
  return sum;
}

Culler::Culler(std::vector<std::shared_ptr<const BodyType>> types, const CullerOptions& options,
               Workers& workers)
    : state_(std::make_unique<State>(std::move(types), options, workers)) {}

Culler::~Culler() = default;

void Culler::step(const BodiesView& bodies, const PoseSource& poses) {
  State& s = *state_;
  assert(bodies.types.size() == bodies.ids.size() && bodies.scales.size() == bodies.ids.size() &&
         bodies.roots.size() == bodies.ids.size());
  assert(std::adjacent_find(bodies.ids.begin(), bodies.ids.end(), std::greater_equal<>()) ==
         bodies.ids.end());
  assert(bodies.ids.empty() || bodies.ids.back() <= PairKey::kMaxId);
  const uint64_t grown_before = s.times_grown();
  const auto start = std::chrono::steady_clock::now();
  Stopwatch whole, stage;
  s.broad.run(bodies, poses, s.slots);
  if (s.deadline != nullptr) {
    s.refine_by_urgency(start, bodies, poses);
  } else {
    s.slots.pose_needed(poses);
    s.refine();
    s.sum_counters();
    stage.lap_ns();
    s.sort_keys(bodies.ids.size());
    s.take_events(bodies);
    s.counters.events_ns = stage.lap_ns();
    s.counters.levels = {};
    s.counters
        .levels[static_cast<size_t>(s.options.exact ? PairLevel::kExact : PairLevel::kPartVolume)] =
        s.sorted_count;
  }
  s.counters.wall_ns = whole.lap_ns();
  s.counters.allocations_grown = s.times_grown() - grown_before;
}

void Culler::finish() {
  if (state_->deadline)
    state_->deadline->finish(state_->events);
  else
    state_->events.advance({});
  state_->hash_events();
}

std::span<const PairKey> Culler::pairs() const { return state_->events.touching(); }
std::span<const PairEvent> Culler::events() const { return state_->events.events(); }
std::span<const uint8_t> Culler::levels() const {
  return state_->deadline ? state_->deadline->levels() : std::span<const uint8_t>();
}
std::span<const uint8_t> Culler::event_levels() const {
  return state_->deadline ? state_->deadline->event_levels() : std::span<const uint8_t>();
}
uint64_t Culler::persisting() const { return state_->events.persisting(); }
const CullingCounters& Culler::counters() const { return state_->counters; }
uint64_t Culler::hash() const { return state_->hash; }

}  // namespace throng
