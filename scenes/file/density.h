// Standing density gives the free ground of a spawn area and the number of people on it.
// Invariant: a point counts as free if the middle of a person may be there.
#pragma once

#include <cstdint>

#include "scenes/file/scene.h"

namespace throng {

/// Highest density in people per m2 without bodies pressing into each other. A person of mean size
/// covers 0.12 m2, and random packings of ellipses jam at about 0.85 coverage.
inline constexpr double kMaxDensity_per_m2 = 6;

/// Area in m2 of a spawn area that people can stand on, clear of obstacles and the ground's edge.
double standing_area_m2(const Scene& scene, const Area& area);

int64_t count_by_density(const Scene& scene, const Group& group);

}  // namespace throng
