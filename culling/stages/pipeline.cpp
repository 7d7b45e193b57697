#include "culling/stages/pipeline.h"

#include <algorithm>
#include <utility>

#include "base/counting_sort.h"
#include "culling/stages/stopwatch.h"

namespace throng {
namespace {

// A task of the narrow phase: enough candidates to fill the registers of most buckets, few enough
// bodies for their poses and boxes (1.2 kB a person) to stay in a core's cache.
constexpr size_t kTaskPairs = 2048, kTaskBlocks = 4;
constexpr size_t kSortBodies = 1024;  // bodies a task when keys are sorted and compared
constexpr uint32_t kRunsAhead = 8;    // whose parts are fetched before they are copied

}  // namespace

Pipeline::Pipeline(BodyTypes types, const CullerOptions& options, Workers& workers)
    : last_level_(last_level(options)),
      workers_(workers),
      shared_(types, options, workers),
      stages_(static_cast<size_t>(workers.threads())),
      posed_(static_cast<size_t>(workers.threads())) {
  if (options.by_part)
    for (PartStage& stage : stages_) stage.tally_parts();
}

void Pipeline::run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
                   CullingCounters& counters) {
  shared_.search(bodies, source);
  refine(source);
  sum_counters(counters);
  Stopwatch watch;
  sort_runs(bodies.ids.size());
  write_pairs(bodies, events);
  counters.events_ns = watch.lap_ns();
  counters.levels = {};
  counters.levels[static_cast<size_t>(last_level_)] = events.touching().size();
}

/// Groups the blocks of the broad phase into tasks_. Depends on the frame alone_, as results must.
void Pipeline::plan_tasks() {
  task_count_ = 0;
  size_t pairs = 0;
  for (size_t block = 0; block < shared_.broad().block_count(); ++block) {
    if (task_count_ == 0 || pairs >= kTaskPairs ||
        block - tasks_[task_count_ - 1].first >= kTaskBlocks) {
      if (tasks_.size() == task_count_) tasks_.emplace_back();
      tasks_[task_count_++].first = block;
      pairs = 0;
    }
    tasks_[task_count_ - 1].end = block + 1;
    pairs += shared_.broad().block(block).size();
  }
}

void Pipeline::refine(const PoseSource& source) {
  plan_tasks();
  for (PartStage& stage : stages_) stage.clear_counters();
  for (PosedBodies& bodies : posed_) {
    bodies.clear_counters();
    bodies.prepare(shared_.slots().count());
  }
  const PartStageFrame parts = shared_.parts();
  workers_.for_blocks(static_cast<int>(task_count_), [&](int index, int worker) {
    Task& task = tasks_[static_cast<size_t>(index)];
    PartStage& stage = stages_[static_cast<size_t>(worker)];
    PosedBodies& bodies = posed_[static_cast<size_t>(worker)];
    for (size_t block = task.first; block < task.end; ++block) {
      for (const SlotPair& pair : shared_.broad().block(block)) {
        bodies.need(pair.a);
        bodies.need(pair.b);
      }
    }
    bodies.pose(shared_.posing(source), alone_);
    stage.begin(parts, bodies);
    for (size_t block = task.first; block < task.end; ++block)
      stage.add(parts, shared_.broad().block(block));
    stage.finish(parts, task.found);
    bodies.clear();
  });
  for (size_t i = 0; i < stages_.size(); ++i) {
    for (size_t other = 0; other < stages_.size(); ++other) {
      stages_[i].reserve_like(stages_[other]);
      posed_[i].reserve_like(posed_[other]);
    }
  }
}

/// Runs by body a with a counting sort, then each body's few by body b.
void Pipeline::sort_runs(size_t bodies) {
  size_t run_count = 0;
  for (size_t t = 0; t < task_count_; ++t) run_count += tasks_[t].found.run_count;
  runs_.resize(run_count);
  start_of_body_.resize(bodies + 2);
  counting_sort(
      bodies, start_of_body_.data(),
      [&](const auto& visit) {
        for (size_t t = 0; t < task_count_; ++t) {
          const PartPairs& found = tasks_[t].found;
          for (size_t i = 0; i < found.run_count; ++i)
            visit(std::pair(&found.runs[i], found.parts.data()));
        }
      },
      [](const auto& run) { return run.first->body_a; },
      [&](const auto& run, uint32_t at) {
        runs_[at] = {run.first->body_b, run.first->count, run.second + run.first->first};
      });
  const size_t blocks = (bodies + kSortBodies - 1) / kSortBodies;
  keys_of_block_.resize(blocks + 1);
  workers_.for_blocks(static_cast<int>(blocks), [&](int index, int) {
    const size_t block = static_cast<size_t>(index);
    const size_t end = std::min(bodies, (block + 1) * kSortBodies);
    uint32_t keys = 0;
    for (size_t body = block * kSortBodies; body < end; ++body) {
      SortedRun* const first = runs_.data() + start_of_body_[body];
      SortedRun* const last = runs_.data() + start_of_body_[body + 1];
      std::sort(first, last,
                [](const SortedRun& x, const SortedRun& y) { return x.body_b < y.body_b; });
      for (const SortedRun* run = first; run != last; ++run) keys += run->count;
    }
    keys_of_block_[block + 1] = keys;
  });
  keys_of_block_[0] = 0;
  for (size_t block = 0; block < blocks; ++block)
    keys_of_block_[block + 1] += keys_of_block_[block];
}

/// The keys of all runs_, with ids, which last, for body indices, which are this frame's; both
/// ascend together.
void Pipeline::write_pairs(const BodiesView& bodies, PairEvents& events) {
  const size_t count = bodies.ids.size(), blocks = (count + kSortBodies - 1) / kSortBodies;
  if (blocks == 0) return events.advance({});
  events.begin(keys_of_block_[blocks], blocks);
  workers_.for_blocks(static_cast<int>(blocks), [&](int index, int) {
    const size_t block = static_cast<size_t>(index);
    const size_t first = block * kSortBodies, end = std::min(count, first + kSortBodies);
    PairKey* out = events.incoming() + keys_of_block_[block];
    const uint32_t run_end = start_of_body_[end];
    for (size_t body = first; body < end; ++body) {
      for (uint32_t r = start_of_body_[body]; r < start_of_body_[body + 1]; ++r) {
        const SortedRun& run = runs_[r];
        // Runs lie where their tasks_ found them, in no order that a cache could know.
        if (r + kRunsAhead < run_end) __builtin_prefetch(runs_[r + kRunsAhead].parts);
        const PairKey bodies_of_run(bodies.ids[body], bodies.ids[run.body_b], 0, 0);
        for (uint32_t i = 0; i < run.count; ++i) *out++ = bodies_of_run.with_parts(run.parts[i]);
      }
    }
    // Bodies that have left since the last frame lie between two ids, or beyond the ends.
    const PairKey low = block == 0 ? PairKey(0, 0, 0, 0) : PairKey(bodies.ids[first], 0, 0, 0);
    const PairKey high = end == count ? PairKey::beyond_all() : PairKey(bodies.ids[end], 0, 0, 0);
    events.compare(block, keys_of_block_[block], keys_of_block_[block + 1], low, high);
  });
  events.finish();
}

void Pipeline::sum_counters(CullingCounters& counters) const {
  PartStageCounters parts;
  PosedBodies::Counters made;
  for (const PartStage& stage : stages_) parts.add(stage.counters());
  for (const PosedBodies& bodies : posed_) made.add(bodies.counters());
  shared_.count(parts, made, counters);
}

PartTally Pipeline::part_tally() const {
  PartTally sum;
  for (const PartStage& stage : stages_)
    if (stage.tally() != nullptr) sum.add(*stage.tally());
  return sum;
}

uint64_t Pipeline::times_grown() const {
  uint64_t sum = shared_.times_grown() + runs_.times_grown() + start_of_body_.times_grown() +
                 keys_of_block_.times_grown();
  for (const PartStage& stage : stages_) sum += stage.times_grown();
  for (const PosedBodies& bodies : posed_) sum += bodies.times_grown();
  for (const Task& task : tasks_) sum += task.found.times_grown();
  return sum;
}

}  // namespace throng
