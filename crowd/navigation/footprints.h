// Footprints are the outlines of obstacles on the ground.
// Invariant: footprints are convex and counter-clockwise.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "crowd/crowd_plan.h"

namespace throng {

/// Convex hull of points in the plane, counter-clockwise, no three in a line (Andrew 1979).
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points);

/// Convex hull of an obstacle's outline seen from above, in world coordinates.
std::vector<Eigen::Vector2d> footprint_of(const Obstacle& obstacle);

/// Convex pieces of an obstacle's outline seen from above: its hull, unless it is a concave mesh.
std::vector<std::vector<Eigen::Vector2d>> footprint_pieces_of(const Obstacle& obstacle);

/// Distance from a point to a footprint; 0 inside.
double distance_m(const std::vector<Eigen::Vector2d>& footprint, const Eigen::Vector2d& point);

/// Footprint of a door's leaf while it is shut.
std::vector<Eigen::Vector2d> footprint_of(const Door& door);

/// Part of a footprint that lies on the ground, counter-clockwise; empty if there is none. A
/// footprint that exceeds the edge by less than the rounding of meshes is returned bit by bit.
std::vector<Eigen::Vector2d> clipped(std::vector<Eigen::Vector2d> footprint,
                                     const Rectangle& ground);

/// Height from which obstacles block no agent (m): 0.1 m above the tallest possible avatar.
double headroom_m(const CrowdPlan& plan);

/// Returns whether avatars cannot walk beneath an obstacle, given the headroom_m() of their scene.
bool blocks_people(const Obstacle& obstacle, double headroom_m);

/// A convex piece of an obstacle that blocks avatars, on the ground.
struct Footprint {
  const Obstacle* obstacle = nullptr;
  std::vector<Eigen::Vector2d> corners;
  uint32_t surface = 0;  ///< see Obstacle::surface; pieces of a concave mesh share a surface
};

/// Footprints in the order of obstacles, if they cover ground; a concave mesh has several. Walls
/// that line the floor are left out, see Walkable. Keeps pointers into `plan`.
std::vector<Footprint> footprints_of(const CrowdPlan& plan);

}  // namespace throng
