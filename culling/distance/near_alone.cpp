#include "culling/distance/near_alone.h"

#include "base/stopwatch.h"

namespace throng {

NearAlone::NearAlone(BodyTypes types, const CullerOptions& options, Workers& workers,
                     NearSearch& near)
    : workers_(workers), near_(near), shared_(types, options, workers, margins_of(options.near)) {}

void NearAlone::run(const BodiesView& bodies, const PoseSource& source, StageCounters& counters) {
  Stopwatch watch;
  shared_.search(bodies, source);
  const BroadPhase& broad = shared_.broad();
  posed_.prepare(shared_.slots().count());
  posed_.clear();
  posed_.clear_counters();
  for (size_t block = 0; block < broad.block_count(); ++block) posed_.need(broad.block(block));
  posed_.pose(shared_.posing(source), workers_);
  const double update_ns = watch.lap_ns();
  near_.begin_frame(shared_.parts(), bodies, broad.block_count());
  workers_.for_blocks(static_cast<int>(broad.block_count()), [&](int block, int worker) {
    near_.begin(worker, posed_);
    near_.add(worker, broad.block(static_cast<size_t>(block)),
              broad.inner(static_cast<size_t>(block)));
    near_.bound(worker, static_cast<size_t>(block));
    near_.finish(worker, static_cast<size_t>(block), {});
  });
  near_.end_frame(counters);
  counters.updates = posed_.counters().parts;
  counters.update_ns = update_ns;
}

}  // namespace throng
