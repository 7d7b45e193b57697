// Arrival decides when an agent has reached an area of a goal, which its centre cannot always
// enter. Invariant: the answer follows from the place, the disc and the walls alone.
#pragma once

#include <Eigen/Core>

#include "base/rectangle.h"
#include "crowd/navigation/walkable.h"

namespace throng {

/// How much farther than the radius of its disc walls keep the centre of an agent that walks
/// straight to them, at most: the model `speed` balances a wish with one wall at 0.16 m, with two
/// side by side at 0.23 m and with four at 0.3 m.
inline constexpr double kMaxWallOffset_m = 0.3;

/// Returns whether the centre at `point`, outside `area`, is as near to it as it gets.
bool is_closest_possible(const Walkable& walkable, const Rectangle& area,
                         const Eigen::Vector2d& point, double radius_m, double wall_offset_m);

/// Returns whether the nearest point of `area` is free, and no obstacle between it and `point`.
bool is_freely_reachable(const Walkable& walkable, const Rectangle& area,
                         const Eigen::Vector2d& point);

/// Returns whether an agent whose centre is at `point` has reached `area`: the centre is inside, or
/// as near to the nearest point of the area as it gets.
///
/// - A wall or an edge of the ground behind that point keeps the centre off by `radius_m` and
///   `wall_offset_m`; so do walls on both sides between which the disc does not fit.
/// - An area that is less than 0.3 m deep from there is passed within a step: the disc touches it.
///
/// A part of the area that lies in or behind an obstacle is out of reach.
inline bool has_reached(const Walkable& walkable, const Rectangle& area,
                        const Eigen::Vector2d& point, double radius_m,
                        double wall_offset_m = kMaxWallOffset_m) {
  const double gap_m = radius_m + wall_offset_m;
  const double square_m2 = (area.nearest_m(point) - point).squaredNorm();
  if (square_m2 == 0) return true;
  // In a corner two walls keep the centre off at once.
  return square_m2 <= 2 * gap_m * gap_m &&
         is_closest_possible(walkable, area, point, radius_m, wall_offset_m);
}

/// Returns whether the nearest point of `area` is free and at most `reach_m` from `point`, with no
/// obstacle in between.
inline bool is_beside(const Walkable& walkable, const Rectangle& area, const Eigen::Vector2d& point,
                      double reach_m) {
  return (area.nearest_m(point) - point).squaredNorm() <= reach_m * reach_m &&
         is_freely_reachable(walkable, area, point);
}

}  // namespace throng
