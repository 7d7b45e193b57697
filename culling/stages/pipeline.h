// Pipeline refines every listed pair completely, task by task.
// Invariant: tasks depend on the frame alone, not on the number of threads.
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
  /// `proximity` computes distances in the same tasks from the same poses; null: no distances.
  Pipeline(BodyTypes types, const CullerOptions& options, Workers& workers,
           ProximitySearch* proximity = nullptr);

  void run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
           CullingCounters& counters) override;
  PartTally part_tally() const override;
  uint64_t times_grown() const override;

 private:
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
  bool proximity_decides_ = false;  // the distance search also decides which part volumes overlap
  ProximitySearch* proximity_;
  SharedStages shared_;
  // By worker.
  std::vector<MidPhase> stages_;
  std::vector<PosedBodies> posed_;
  Workers serial_{1};  // a task poses its bodies on its own thread
  std::vector<Task> tasks_;
  size_t task_count_ = 0;
  SortedRuns<uint16_t> runs_;  // PairKey::parts_of()
};

}  // namespace throng
