// Part pairs by the million, held against triangles in double precision: whatever touches must be
// reported by the whole culling pass.
// One rule: only near pairs count, see bench/workbench/random_pairs.h.
#pragma once

#include <cstdint>
#include <string>

#include "bench/workbench/random_pairs.h"

namespace throng::test {

using bench::Family;
using bench::kFamilies;
using bench::name_of;

struct ProximityPairs {
  uint64_t tested = 0;
  uint64_t touching = 0;   ///< by their triangles, or one inside the other
  uint64_t reported = 0;   ///< of the near ones
  uint64_t missed = 0;     ///< touching and not reported
  uint64_t differing = 0;  ///< frames in which the scalar reference reports other pairs
  std::string first_miss, first_difference;
};

/// At least `pairs` near pairs, in whole rounds over all part volumes and SIMD targets of this
/// machine, pair searches in turn.
ProximityPairs check_proximity_pairs(Family family, uint64_t pairs, uint64_t seed);

/// A frame for each of `maps` random maps from parts to volumes. `differing` counts, too, where
/// another SIMD target, pair search or number of threads gives another hash, and where triangles
/// decide otherwise than behind one volume.
ProximityPairs check_mixtures(Family family, int maps, uint64_t seed);

}  // namespace throng::test
