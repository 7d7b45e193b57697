// What a run is called and by which options it was made.
// One rule: equal ids, equal events; what changes no frame stays out of the id.
#pragma once

#include "scenes/run/simulation.h"

namespace throng {

/// Fills in the run id, the instance, and what the options say. `world_hash`:
/// World::content_hash().
void identify_run(const Scene& scene, const SimulationOptions& options, uint64_t world_hash,
                  RunInfo& info);

}  // namespace throng
