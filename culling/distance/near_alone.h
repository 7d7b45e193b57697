// Distances under a deadline: searched and posed beside the narrow phase, which refines only what
// it has time for. All that is near is listed, and triangles are asked as long as the budget lasts.
// One rule: what the narrow phase does is not changed.
#pragma once

#include "culling/distance/near_search.h"
#include "culling/stages/shared_stages.h"

namespace throng {

class NearAlone {
 public:
  /// Keeps references to all three.
  NearAlone(BodyTypes types, const CullerOptions& options, Workers& workers, NearSearch& near);

  void run(const BodiesView& bodies, const PoseSource& source, StageCounters& counters);
  uint64_t times_grown() const { return shared_.times_grown() + posed_.times_grown(); }

 private:
  Workers& workers_;
  NearSearch& near_;
  SharedStages shared_;
  PosedBodies posed_;
};

}  // namespace throng
