// check_proximity_rows() checks proximity rows of random pairs of bodies, with all options.
#pragma once

#include <cstdint>

#include "bench/workbench/random_pairs.h"
#include "tests/culling/proximity_oracle.h"

namespace throng::test {

/// Checks at least `pairs` pairs within margins of 0.02 to 0.3 m, by volumes and by triangles. SIMD
/// targets, pair searches and numbers of threads alternate.
ProximityTally check_proximity_rows(bench::Family family, uint64_t pairs, uint64_t seed);

}  // namespace throng::test
