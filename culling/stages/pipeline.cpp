#include "culling/stages/pipeline.h"

#include "base/stopwatch.h"
#include "culling/distance/proximity_search.h"

namespace throng {
namespace {

// A task ends at this many pairs, which fill the registers of most buckets. It also ends at this
// many blocks, to keep poses and boxes of its bodies (1.2 kB per person) in a core's cache.
constexpr size_t kTaskPairs = 2048, kTaskBlocks = 4;

}  // namespace

Pipeline::Pipeline(BodyTypes types, const CullerOptions& options, Workers& workers,
                   ProximitySearch* proximity)
    : last_level_(last_level(options)),
      workers_(workers),
      proximity_(proximity),
      shared_(types, options, workers,
              proximity == nullptr ? Margins() : margins_of(options.proximity)),
      stages_(static_cast<size_t>(workers.threads())),
      posed_(static_cast<size_t>(workers.threads())) {
  if (options.by_part)
    for (MidPhase& stage : stages_) stage.tally_parts();
  // Distances use the usual part volumes here, so one test serves both.
  proximity_decides_ = proximity != nullptr && !options.by_part && !shared_.parts().is_mixed &&
                       shared_.parts().volume == VolumeKind::kOrdop26;
  if (proximity_decides_) proximity->share_boxes();
}

void Pipeline::run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
                   CullingCounters& counters) {
  shared_.search(bodies, source);
  plan_tasks();
  if (proximity_) proximity_->begin_frame(shared_.parts(), bodies, task_count_);
  refine(source);
  sum_counters(counters);
  Stopwatch watch;
  sort_runs(bodies.ids.size());
  write_pairs(bodies, events);
  counters.events_ns = watch.lap_ns();
  counters.levels = {};
  counters.levels[static_cast<size_t>(last_level_)] = events.touching().size();
  if (proximity_) proximity_->end_frame(counters.proximity);
}

/// Groups the blocks of the broad phase into tasks_. Depends only on the frame, as results must.
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
  for (MidPhase& stage : stages_) stage.clear_counters();
  for (PosedBodies& bodies : posed_) {
    bodies.clear_counters();
    bodies.prepare(shared_.slots().count());
  }
  const MidPhaseFrame parts = shared_.parts();
  workers_.for_blocks(static_cast<int>(task_count_), [&](int index, int worker) {
    Task& task = tasks_[static_cast<size_t>(index)];
    MidPhase& stage = stages_[static_cast<size_t>(worker)];
    PosedBodies& bodies = posed_[static_cast<size_t>(worker)];
    for (size_t block = task.first; block < task.end; ++block)
      bodies.request(shared_.broad().block(block));
    bodies.pose(shared_.posing(source), serial_);
    stage.begin(parts, bodies);
    if (proximity_) proximity_->begin(worker, bodies);
    for (size_t block = task.first; block < task.end; ++block) {
      if (proximity_)
        proximity_->add(worker, shared_.broad().block(block), shared_.broad().inner(block));
      if (!proximity_decides_) stage.add(parts, shared_.broad().block(block));
    }
    if (proximity_) proximity_->bound(worker, static_cast<size_t>(index));
    std::span<const uint8_t> touches;
    if (proximity_ && proximity_decides_) {
      const ProximityCandidates& proximity = proximity_->parts(worker);
      stage.finish(parts, proximity.parts(), proximity.overlaps(), task.found);
      touches = stage.touches(parts);
    } else {
      stage.finish(parts, task.found);
    }
    if (proximity_) proximity_->finish(worker, static_cast<size_t>(index), touches);
    bodies.clear();
  });
  for (size_t i = 0; i < stages_.size(); ++i) {
    for (size_t other = 0; other < stages_.size(); ++other) {
      stages_[i].reserve_like(stages_[other]);
      posed_[i].reserve_like(posed_[other]);
    }
  }
}

void Pipeline::sort_runs(size_t bodies) {
  using BodyRun = SortedRuns<uint16_t>::BodyRun;
  runs_.sort(bodies, workers_, [&](const auto& visit) {
    for (size_t t = 0; t < task_count_; ++t) {
      const PartPairs& found = tasks_[t].found;
      for (size_t i = 0; i < found.run_count; ++i) {
        const PartRun& run = found.runs[i];
        visit(BodyRun{run.body_a, {run.body_b, run.count, found.parts.data() + run.first}});
      }
    }
  });
}

/// Writes the keys of all runs. Body indices become lasting ids; both have the same order.
void Pipeline::write_pairs(const BodiesView& bodies, PairEvents& events) {
  const size_t count = bodies.ids.size(), blocks = runs_.block_count();
  if (blocks == 0) return events.advance({});
  events.begin(runs_.item_count(), blocks);
  workers_.for_blocks(static_cast<int>(blocks), [&](int index, int) {
    const size_t block = static_cast<size_t>(index);
    const size_t first = runs_.first_body(block), end = runs_.end_body(block);
    PairKey* out = events.incoming() + runs_.items_before(block);
    runs_.for_runs(block, [&](size_t body_a, const auto& run) {
      const PairKey bodies_of_run(bodies.ids[body_a], bodies.ids[run.body_b], 0, 0);
      for (uint32_t i = 0; i < run.count; ++i) *out++ = bodies_of_run.with_parts(run.items[i]);
    });
    // Bodies that left since the last frame lie between two ids, or beyond the ends.
    const PairKey low = block == 0 ? PairKey(0, 0, 0, 0) : PairKey(bodies.ids[first], 0, 0, 0);
    const PairKey high = end == count ? PairKey::beyond_all() : PairKey(bodies.ids[end], 0, 0, 0);
    events.compare(block, runs_.items_before(block), runs_.items_before(block + 1), low, high);
  });
  events.finish();
}

void Pipeline::sum_counters(CullingCounters& counters) const {
  MidPhaseCounters parts;
  PosedBodies::Counters made;
  for (const MidPhase& stage : stages_) parts.add(stage.counters());
  for (const PosedBodies& bodies : posed_) made.add(bodies.counters());
  if (proximity_decides_) {
    const PartCandidates::Counters boxes = proximity_->box_counters();
    parts.body_box += boxes.body_box;
    parts.part_box += boxes.part_box;
  }
  shared_.count(parts, made, counters);
}

PartTally Pipeline::part_tally() const {
  PartTally sum;
  for (const MidPhase& stage : stages_)
    if (stage.tally() != nullptr) sum.add(*stage.tally());
  return sum;
}

uint64_t Pipeline::times_grown() const {
  uint64_t sum = shared_.times_grown() + runs_.times_grown();
  for (const MidPhase& stage : stages_) sum += stage.times_grown();
  for (const PosedBodies& bodies : posed_) sum += bodies.times_grown();
  for (const Task& task : tasks_) sum += task.found.times_grown();
  return sum;
}

}  // namespace throng
