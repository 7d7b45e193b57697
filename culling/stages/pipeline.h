// The pass of a usual run: every pair that the search lists is refined to the end, task by task.
// One rule: tasks depend on the frame alone, not on the number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "culling/stages/pass.h"
#include "culling/stages/shared_stages.h"

namespace throng {

class Pipeline final : public Pass {
 public:
  Pipeline(BodyTypes types, const CullerOptions& options, Workers& workers);

  void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
           CullingCounters& counters) override;
  PartTally part_tally() const override;
  uint64_t times_grown() const override;

 private:
  /// Consecutive blocks of the broad phase, and what they yield.
  struct Task {
    size_t first = 0, end = 0;
    PartPairs found;
  };
  /// The parts of a pair of bodies; runs lie in the order of body a.
  struct SortedRun {
    uint32_t body_b, count;
    const uint16_t* parts;
  };

  void plan_tasks();
  void refine(const PoseSource& source);
  void sort_runs(size_t bodies);
  void write_pairs(const BodiesView& bodies, PairEvents& events);
  void sum_counters(CullingCounters& counters) const;

  PairLevel last_level_;
  Workers& workers_;
  SharedStages shared_;
  // One a worker.
  std::vector<PartStage> stages_;
  std::vector<PosedBodies> posed_;
  Workers alone_{1};  // a task poses its bodies by itself
  std::vector<Task> tasks_;
  size_t task_count_ = 0;
  GrowBuffer<SortedRun> runs_;
  GrowBuffer<uint32_t> start_of_body_, keys_of_block_;
};

}  // namespace throng
