// The pass of a usual run: every pair that the search lists is refined to the end, task by task.
// One rule: tasks depend on the frame alone, not on the number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "culling/stages/pass.h"
#include "culling/stages/shared_stages.h"
#include "culling/stages/sorted_runs.h"

namespace throng {

class ProximitySearch;

class Pipeline final : public Pass {
 public:
  /// `near` finds distances in the same tasks, of the same poses; null where none is asked.
  Pipeline(BodyTypes types, const CullerOptions& options, Workers& workers,
           ProximitySearch* proximity = nullptr);

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
  void plan_tasks();
  void refine(const PoseSource& source);
  void sort_runs(size_t bodies);
  void write_pairs(const BodiesView& bodies, PairEvents& events);
  void sum_counters(CullingCounters& counters) const;

  PairLevel last_level_;
  Workers& workers_;
  bool proximity_decides_ = false;  // which part volumes overlap, too
  ProximitySearch* proximity_;
  SharedStages shared_;
  // One a worker.
  std::vector<MidPhase> stages_;
  std::vector<PosedBodies> posed_;
  Workers serial_{1};  // a task poses its bodies by itself
  std::vector<Task> tasks_;
  size_t task_count_ = 0;
  SortedRuns<uint16_t> runs_;  // PairKey::parts_of()
};

}  // namespace throng
