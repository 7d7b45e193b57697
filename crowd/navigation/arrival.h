// Arrival decides when an agent has reached an area of a goal, which its centre cannot always
// enter.
// Invariant: the answer follows from the place, the disc and the walls alone.
#pragma once

#include <Eigen/Core>

#include "crowd/navigation/walkable.h"
#include "geometry/area.h"

namespace throng {

/// Largest distance, beyond the disc's radius, at which walls stop an agent that walks straight to
/// them. The model `collision_free_speed` stops at 0.16 m before one wall, 0.23 m between two side
/// by side and 0.3 m between four.
inline constexpr double kMaxWallOffset_m = 0.3;

/// Returns whether the centre at `point`, outside `area`, is as close to it as it can be.
bool is_closest_possible(const Walkable& walkable, const Area& area, const Eigen::Vector2d& point,
                         double radius_m, double wall_offset_m);

/// Returns whether the nearest point of `area` is free, without an obstacle between it and `point`.
bool is_freely_reachable(const Walkable& walkable, const Area& area, const Eigen::Vector2d& point);

/// Returns whether an agent whose centre is at `point` has reached `area`. The centre is inside or
/// as close to the area as it can be.
///
/// - A wall or an edge of the ground behind that point stops the centre at `radius_m` and
///   `wall_offset_m`. So do walls on both sides between which the disc does not fit.
/// - An area less than 0.3 m deep from there is passed within a step: the disc has to touch it.
///
/// A part of the area that lies in or behind an obstacle is out of reach.
inline bool has_reached(const Walkable& walkable, const Area& area, const Eigen::Vector2d& point,
                        double radius_m, double wall_offset_m = kMaxWallOffset_m) {
  const double gap_m = radius_m + wall_offset_m;
  const double square_m2 = (area.nearest_m(point) - point).squaredNorm();
  if (square_m2 == 0) return true;
  // In a corner two walls stop the centre at once.
  return square_m2 <= 2 * gap_m * gap_m &&
         is_closest_possible(walkable, area, point, radius_m, wall_offset_m);
}

/// Returns whether the nearest point of `area` is free, visible and at most `reach_m` from `point`.
inline bool is_beside(const Walkable& walkable, const Area& area, const Eigen::Vector2d& point,
                      double reach_m) {
  return (area.nearest_m(point) - point).squaredNorm() <= reach_m * reach_m &&
         is_freely_reachable(walkable, area, point);
}

}  // namespace throng
