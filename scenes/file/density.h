// How many people a group has whose scene says how close together they stand.
// One rule: the ground counts where the middle of somebody may be.
#pragma once

#include <cstdint>

#include "scenes/file/scene.h"

namespace throng {

/// The densest that bodies can stand without pressing into each other: people of mean size cover
/// 0.12 m2 of the ground, and heaps of ellipses jam where these cover some 0.85 of it.
inline constexpr double kMaxDensity_per_m2 = 6;

/// The part of a spawn area, in m2, that is free to stand on: half a metre of shoulders keeps off
/// obstacles and the edges of the ground.
double standing_area_m2(const Scene& scene, const Rectangle& area);

/// Of a group with a density: how many that makes.
int64_t count_by_density(const Scene& scene, const Group& group);

}  // namespace throng
