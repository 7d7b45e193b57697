// What obstacles cover of the ground.
// One rule: footprints are convex and counter-clockwise.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "scenes/file/scene.h"

namespace throng {

/// The convex hull of points of the plane, counter-clockwise, no three in a line (Andrew 1979).
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points);

/// What an obstacle covers in the plane of the ground, in world coordinates: the convex hull of its
/// outline seen from above.
std::vector<Eigen::Vector2d> footprint_of(const Obstacle& obstacle);

/// How far a point is from a footprint; 0 inside.
double distance_m(const std::vector<Eigen::Vector2d>& footprint, const Eigen::Vector2d& point);

/// What the leaf of a door covers while it is shut.
std::vector<Eigen::Vector2d> footprint_of(const Door& door);

/// True if people cannot walk beneath it.
bool blocks_people(const Obstacle& obstacle);

}  // namespace throng
