// Near rows of couples of bodies by the million, on every path, judged one by one.
#pragma once

#include <cstdint>

#include "bench/workbench/random_pairs.h"
#include "tests/culling/proximity_oracle.h"

namespace throng::test {

/// At least `pairs` pairs within margins of 0.02 to 0.3 m, by volumes and by triangles, on SIMD
/// targets, pair searches and threads in turn.
ProximityTally check_proximity_rows(bench::Family family, uint64_t pairs, uint64_t seed);

}  // namespace throng::test
