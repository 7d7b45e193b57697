// What obstacles cover of the ground.
// One rule: footprints are convex and counter-clockwise.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "crowd/crowd_plan.h"

namespace throng {

/// The convex hull of points of the plane, counter-clockwise, no three in a line (Andrew 1979).
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points);

/// The smallest rectangle that holds points, of which there is at least one.
Rectangle bounds_of(const std::vector<Eigen::Vector2d>& points);

/// What an obstacle covers in the plane of the ground, in world coordinates: the convex hull of its
/// outline seen from above.
std::vector<Eigen::Vector2d> footprint_of(const Obstacle& obstacle);

/// How far a point is from a footprint; 0 inside.
double distance_m(const std::vector<Eigen::Vector2d>& footprint, const Eigen::Vector2d& point);

/// What the leaf of a door covers while it is shut.
std::vector<Eigen::Vector2d> footprint_of(const Door& door);

/// The part of a footprint that lies on the ground, counter-clockwise; empty if there is none. One
/// that reaches over the edge by less than the rounding of meshes stays as it is, bit by bit.
std::vector<Eigen::Vector2d> clipped(std::vector<Eigen::Vector2d> footprint,
                                     const Rectangle& ground);

/// How high over the ground an obstacle must hang to block nobody (m): 0.1 m above the tallest
/// avatar that the scene may have.
double headroom_m(const CrowdPlan& plan);

/// True if avatars cannot walk beneath it, given the headroom_m() of their scene.
bool blocks_people(const Obstacle& obstacle, double headroom_m);

/// An obstacle that blocks avatars, and what it covers of the ground.
struct Footprint {
  const Obstacle* obstacle = nullptr;
  std::vector<Eigen::Vector2d> corners;
};

/// In the order of the obstacles; those that cover none of the ground are left out. The scene must
/// outlive them.
std::vector<Footprint> footprints_of(const CrowdPlan& plan);

}  // namespace throng
