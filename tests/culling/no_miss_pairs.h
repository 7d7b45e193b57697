// check_no_misses() compares the pairs of a culling pass with triangle tests in double precision:
// all touching pairs must be reported. Only near pairs count, see bench/workbench/random_pairs.h.
#pragma once

#include <cstdint>
#include <string>

#include "bench/workbench/random_pairs.h"

namespace throng::test {

using bench::Family;
using bench::kFamilies;
using bench::name_of;

struct NoMissCounts {
  uint64_t tested = 0;
  uint64_t touching = 0;   ///< number with touching triangles, or one inside the other
  uint64_t reported = 0;   ///< number of near pairs reported
  uint64_t missed = 0;     ///< number touching but not reported
  uint64_t differing = 0;  ///< number of frames that differ from the scalar reference
  std::string first_miss, first_difference;
};

/// Tests at least `pairs` near pairs, in complete rounds over all part volumes and SIMD targets of
/// this machine; pair searches alternate.
NoMissCounts check_no_misses(Family family, uint64_t pairs, uint64_t seed);

/// Tests one frame for each of `maps` random maps from parts to volumes. `differing` also counts
/// frames whose hash depends on SIMD target, pair search or threads. It also counts frames in which
/// triangles give another result than with a single volume.
NoMissCounts check_mixtures(Family family, int maps, uint64_t seed);

}  // namespace throng::test
