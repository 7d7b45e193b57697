// Where two parts touch: one point that both share.
// One rule: it lies where triangles cross, and no crossing is nearer by more than kNearer_m to a
// place that is given (where the hulls are deepest in each other); or inside a solid, where one
// part holds the other.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "culling/distance/surface_distance.h"

namespace throng {

/// Half of the time went into the last centimetre.
inline constexpr double kNearer_m = 0.01;

/// Relative to A's root, in world axes, as near_m; nothing for parts that do not touch. No
/// allocation.
std::optional<Eigen::Vector3d> contact_point(const PlacedSurface& a, const PlacedSurface& b,
                                             const Eigen::Vector3f& a_to_b_m,
                                             const Eigen::Vector3d& near_m,
                                             ExactCounters& counters);

}  // namespace throng
