#include "culling/culler.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <utility>

#include "base/counting_sort.h"
#include "base/errors.h"
#include "culling/deadline/deadline.h"
#include "culling/event_hash.h"
#include "culling/stages/broad_phase.h"
#include "culling/stages/part_stage.h"
#include "culling/stages/slots.h"
#include "culling/stages/stopwatch.h"
#include "culling/strategies/recipe.h"
#include "culling/volumes/fitted.h"

namespace throng {
namespace {

// A task of the narrow phase: enough candidates to fill the registers of most buckets, few enough
// bodies for their poses and boxes (1.2 kB a person) to stay in a core's cache.
constexpr size_t kTaskPairs = 2048, kTaskBlocks = 4;
constexpr size_t kSortBodies = 1024;  // bodies a task when keys are sorted and compared
constexpr uint32_t kRunsAhead = 8;    // whose parts are fetched before they are copied

}  // namespace

struct Culler::State {
  State(std::vector<std::shared_ptr<const BodyType>> body_types, const CullerOptions& opts,
        Workers& pool);

  void plan_tasks();
  PartStageFrame part_stage_frame() const {
    return {types,    shape_type,          type_first_shape, type_parts,
            &kernels, options.part_volume, options.exact};
  }
  void refine(const PoseSource& source);
  void refine_by_urgency(std::chrono::steady_clock::time_point start, const BodiesView& bodies,
                         const PoseSource& source);
  void run_recipe(const BodiesView& bodies, const PoseSource& source);
  void sort_runs(size_t bodies);
  void write_pairs(const BodiesView& bodies);
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
  // One a worker.
  std::vector<PartStage> stages;
  std::vector<PosedBodies> posed;
  Workers alone{1};  // a task poses its bodies by itself

  /// Consecutive blocks of the broad phase, and what they yield.
  struct Task {
    size_t first = 0, end = 0;
    PartPairs found;
  };
  std::vector<Task> tasks;
  size_t task_count = 0;

  /// The parts of a pair of bodies; runs lie in the order of body a.
  struct SortedRun {
    uint32_t body_b, count;
    const uint16_t* parts;
  };
  GrowBuffer<SortedRun> runs;
  GrowBuffer<uint32_t> start_of_body, keys_of_block;
  PairEvents events;
  std::unique_ptr<Deadline> deadline;  // null without one
  std::unique_ptr<Recipe> recipe;      // null for our own pipeline
  GrowBuffer<PairKey> recipe_pairs;    // with ids
  GrowBuffer<uint8_t> sphere_levels;   // zeros, for spheres alone
  CullingCounters counters;
  EventHash hash;
  uint64_t frame = 0;
};

Culler::State::State(std::vector<std::shared_ptr<const BodyType>> body_types,
                     const CullerOptions& opts, Workers& pool)
    : types(std::move(body_types)),
      options(opts),
      workers(pool),
      kernels(kernels_for(opts.simd)),
      slots(types),
      broad(types, kernels, pool, opts.pair_search),
      stages(static_cast<size_t>(pool.threads())),
      posed(static_cast<size_t>(pool.threads())) {
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
  if (options.strategy == Strategy::kPipeline) return;
  assert(!deadline);
  if (options.exact && options.strategy == Strategy::kSphere)
    throw InputError("exact contacts", "a strategy that tests parts", "spheres alone");
  recipe = Recipe::make(options, types);
}

/// Groups the blocks of the broad phase into tasks. Depends on the frame alone, as results must.
void Culler::State::plan_tasks() {
  task_count = 0;
  size_t pairs = 0;
  for (size_t block = 0; block < broad.block_count(); ++block) {
    if (task_count == 0 || pairs >= kTaskPairs ||
        block - tasks[task_count - 1].first >= kTaskBlocks) {
      if (tasks.size() == task_count) tasks.emplace_back();
      tasks[task_count++].first = block;
      pairs = 0;
    }
    tasks[task_count - 1].end = block + 1;
    pairs += broad.block(block).size();
  }
}

void Culler::State::refine(const PoseSource& source) {
  plan_tasks();
  for (PartStage& stage : stages) stage.clear_counters();
  for (PosedBodies& bodies : posed) {
    bodies.clear_counters();
    bodies.prepare(slots.count());
  }
  const PartStageFrame shared = part_stage_frame();
  workers.for_blocks(static_cast<int>(task_count), [&](int index, int worker) {
    Task& task = tasks[static_cast<size_t>(index)];
    PartStage& stage = stages[static_cast<size_t>(worker)];
    PosedBodies& bodies = posed[static_cast<size_t>(worker)];
    for (size_t block = task.first; block < task.end; ++block) {
      for (const SlotPair& pair : broad.block(block)) {
        bodies.need(pair.a);
        bodies.need(pair.b);
      }
    }
    bodies.pose({types, kernels, slots, source}, alone);
    stage.begin(shared, bodies);
    for (size_t block = task.first; block < task.end; ++block)
      stage.add(shared, broad.block(block));
    stage.finish(shared, task.found);
    bodies.clear();
  });
  for (size_t i = 0; i < stages.size(); ++i) {
    for (size_t other = 0; other < stages.size(); ++other) {
      stages[i].reserve_like(stages[other]);
      posed[i].reserve_like(posed[other]);
    }
  }
}

/// The narrow phase under a deadline: poses, refines and takes events by itself.
void Culler::State::refine_by_urgency(std::chrono::steady_clock::time_point start,
                                      const BodiesView& bodies, const PoseSource& source) {
  deadline->refine(start, bodies, {types, kernels, slots, source}, broad, part_stage_frame());
  sum_counters();
  Stopwatch watch;
  deadline->take_events(bodies, events);
  hash_events();
  counters.events_ns = watch.lap_ns();
  counters.levels = deadline->reported();
}

/// One of the paper's strategies in place of everything up to the events.
void Culler::State::run_recipe(const BodiesView& bodies, const PoseSource& source) {
  recipe->run(bodies, source);
  Stopwatch watch;
  const std::span<const PairKey> found = recipe->pairs();
  recipe_pairs.resize(found.size());
  for (size_t i = 0; i < found.size(); ++i)
    recipe_pairs[i] = PairKey(bodies.ids[found[i].a()], bodies.ids[found[i].b()], found[i].part_a(),
                              found[i].part_b());
  events.advance({recipe_pairs.data(), found.size()});
  const bool spheres_alone = options.strategy == Strategy::kSphere;
  if (spheres_alone) {
    const size_t most = std::max(events.touching().size(), events.events().size());
    sphere_levels.resize(most);
    std::fill_n(sphere_levels.data(), most, static_cast<uint8_t>(PairLevel::kSphere));
  }
  hash_events();
  counters.events_ns = watch.lap_ns();
  counters.avatar = recipe->spheres();
  counters.body_box = counters.box = {.volume = "off"};
  counters.part = recipe->volumes();
  counters.exact = recipe->triangles();
  counters.primitive_tests = recipe->primitive_tests();
  counters.posed_bodies = recipe->posed_bodies();
  counters.levels = {};
  counters.levels[spheres_alone   ? 0
                  : options.exact ? static_cast<size_t>(PairLevel::kExact)
                                  : static_cast<size_t>(PairLevel::kPartVolume)] = found.size();
}

/// Runs by body a with a counting sort, then each body's few by body b.
void Culler::State::sort_runs(size_t bodies) {
  size_t run_count = 0;
  for (size_t t = 0; t < task_count; ++t) run_count += tasks[t].found.run_count;
  runs.resize(run_count);
  start_of_body.resize(bodies + 2);
  counting_sort(
      bodies, start_of_body.data(),
      [&](const auto& visit) {
        for (size_t t = 0; t < task_count; ++t) {
          const PartPairs& found = tasks[t].found;
          for (size_t i = 0; i < found.run_count; ++i)
            visit(std::pair(&found.runs[i], found.parts.data()));
        }
      },
      [](const auto& run) { return run.first->body_a; },
      [&](const auto& run, uint32_t at) {
        runs[at] = {run.first->body_b, run.first->count, run.second + run.first->first};
      });
  const size_t blocks = (bodies + kSortBodies - 1) / kSortBodies;
  keys_of_block.resize(blocks + 1);
  workers.for_blocks(static_cast<int>(blocks), [&](int index, int) {
    const size_t block = static_cast<size_t>(index);
    const size_t end = std::min(bodies, (block + 1) * kSortBodies);
    uint32_t keys = 0;
    for (size_t body = block * kSortBodies; body < end; ++body) {
      SortedRun* const first = runs.data() + start_of_body[body];
      SortedRun* const last = runs.data() + start_of_body[body + 1];
      std::sort(first, last,
                [](const SortedRun& x, const SortedRun& y) { return x.body_b < y.body_b; });
      for (const SortedRun* run = first; run != last; ++run) keys += run->count;
    }
    keys_of_block[block + 1] = keys;
  });
  keys_of_block[0] = 0;
  for (size_t block = 0; block < blocks; ++block) keys_of_block[block + 1] += keys_of_block[block];
}

/// The keys of all runs, with ids, which last, for body indices, which are this frame's; both
/// ascend together.
void Culler::State::write_pairs(const BodiesView& bodies) {
  const size_t count = bodies.ids.size(), blocks = (count + kSortBodies - 1) / kSortBodies;
  if (blocks == 0) return events.advance({});
  events.begin(keys_of_block[blocks], blocks);
  workers.for_blocks(static_cast<int>(blocks), [&](int index, int) {
    const size_t block = static_cast<size_t>(index);
    const size_t first = block * kSortBodies, end = std::min(count, first + kSortBodies);
    PairKey* out = events.incoming() + keys_of_block[block];
    const uint32_t run_end = start_of_body[end];
    for (size_t body = first; body < end; ++body) {
      for (uint32_t r = start_of_body[body]; r < start_of_body[body + 1]; ++r) {
        const SortedRun& run = runs[r];
        // Runs lie where their tasks found them, in no order that a cache could know.
        if (r + kRunsAhead < run_end) __builtin_prefetch(runs[r + kRunsAhead].parts);
        const PairKey bodies_of_run(bodies.ids[body], bodies.ids[run.body_b], 0, 0);
        for (uint32_t i = 0; i < run.count; ++i) *out++ = bodies_of_run.with_parts(run.parts[i]);
      }
    }
    // Bodies that have left since the last frame lie between two ids, or beyond the ends.
    const PairKey low = block == 0 ? PairKey(0, 0, 0, 0) : PairKey(bodies.ids[first], 0, 0, 0);
    const PairKey high = end == count ? PairKey::beyond_all() : PairKey(bodies.ids[end], 0, 0, 0);
    events.compare(block, keys_of_block[block], keys_of_block[block + 1], low, high);
  });
  events.finish();
}

void Culler::State::hash_events() {
  EventSum sum;
  sum.add(events.events(), deadline ? deadline->event_levels() : std::span<const uint8_t>());
  hash.add_frame(frame++, sum);
}

void Culler::State::sum_counters() {
  PartStageCounters parts;
  PosedBodies::Counters made;
  for (const PartStage& stage : stages) parts.add(stage.counters());
  for (const PosedBodies& bodies : posed) made.add(bodies.counters());
  if (deadline) {
    parts = deadline->counters();
    made = deadline->posed();
  }
  counters.avatar = broad.counters();
  counters.body_box = parts.body_box;
  counters.body_box.volume = "aabb";
  counters.body_box.tests += broad.apart_by_bounds();
  counters.body_box.updates = made.bodies;
  counters.box = parts.box;
  counters.box.volume = "aabb";
  counters.box.updates = made.parts;
  counters.box.update_ns = made.box_ns;
  counters.part = parts.part;
  counters.part.volume = name_of(options.part_volume);
  counters.part.updates += made.parts;
  counters.part.update_ns += made.pose_ns;
  counters.exact = parts.exact;
  counters.exact.volume = options.exact ? "triangles" : "off";
  counters.primitive_tests = parts.primitive_tests;
  counters.posed_bodies = made.bodies;
  counters.pose_ns = made.pose_ns;
}

uint64_t Culler::State::times_grown() const {
  uint64_t sum = slots.times_grown() + broad.times_grown() + runs.times_grown() +
                 start_of_body.times_grown() + keys_of_block.times_grown() + events.times_grown();
  for (const PartStage& stage : stages) sum += stage.times_grown();
  for (const PosedBodies& bodies : posed) sum += bodies.times_grown();
  for (const Task& task : tasks) sum += task.found.times_grown();
  if (deadline) sum += deadline->times_grown();
  if (recipe)
    sum += recipe->times_grown() + recipe_pairs.times_grown() + sphere_levels.times_grown();
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
  if (s.recipe == nullptr) s.broad.run(bodies, poses, s.slots);
  if (s.recipe != nullptr) {
    s.run_recipe(bodies, poses);
  } else if (s.deadline != nullptr) {
    s.refine_by_urgency(start, bodies, poses);
  } else {
    s.refine(poses);
    s.sum_counters();
    stage.lap_ns();
    s.sort_runs(bodies.ids.size());
    s.write_pairs(bodies);
    s.hash_events();
    s.counters.events_ns = stage.lap_ns();
    const PairLevel level = s.options.exact ? PairLevel::kExact : PairLevel::kPartVolume;
    s.counters.levels = {};
    s.counters.levels[static_cast<size_t>(level)] = s.events.touching().size();
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

void Culler::archive(Archive& a) {
  State& s = *state_;
  uint64_t hash = s.hash.value();
  a(s.frame, hash);
  s.hash = EventHash(hash);
  const std::span<const PairKey> now = s.events.touching();
  std::vector<PairKey> touching(now.begin(), now.end());
  a.resized(touching, SIZE_MAX);
  if (a.is_reading()) {
    if (std::adjacent_find(touching.begin(), touching.end(), std::greater_equal<>()) !=
        touching.end())
      a.refuse("pairs in order", "pairs in disorder");
    for (const PairKey& key : touching)
      if (key.a() >= key.b()) a.refuse("pairs of two bodies", "a body with itself");
    s.events.resume(touching);
  }
  if (s.deadline) s.deadline->archive(a, touching);
}

std::span<const PairKey> Culler::pairs() const { return state_->events.touching(); }
std::span<const PairEvent> Culler::events() const { return state_->events.events(); }
std::span<const uint8_t> Culler::levels() const {
  if (state_->options.strategy == Strategy::kSphere)
    return {state_->sphere_levels.data(), pairs().size()};
  return state_->deadline ? state_->deadline->levels() : std::span<const uint8_t>();
}
std::span<const uint8_t> Culler::event_levels() const {
  if (state_->options.strategy == Strategy::kSphere)
    return {state_->sphere_levels.data(), events().size()};
  return state_->deadline ? state_->deadline->event_levels() : std::span<const uint8_t>();
}
uint64_t Culler::persisting() const { return state_->events.persisting(); }
const CullingCounters& Culler::counters() const { return state_->counters; }
uint64_t Culler::hash() const { return state_->hash.value(); }

}  // namespace throng
