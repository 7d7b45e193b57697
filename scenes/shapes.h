// The solids that obstacles are made of, and what they cover of the ground.
// One rule: meshes are closed and oriented outwards; footprints are convex, counter-clockwise.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "avatars/mesh.h"
#include "scenes/scene.h"

namespace throng {

/// A box about the origin with these edge lengths: 8 vertices, 12 triangles.
Mesh box_mesh(const Eigen::Vector3d& size_m);

/// An upright cylinder about the origin: a prism of kCylinderSides sides whose vertices lie on the
/// circle.
Mesh cylinder_mesh(double diameter_m, double height_m);
inline constexpr int kCylinderSides = 32;

/// The convex hull of points of the plane, counter-clockwise, no three in a line (Andrew 1979).
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points);

/// What an obstacle covers in the plane of the ground, in world coordinates: the convex hull of its
/// outline seen from above.
std::vector<Eigen::Vector2d> footprint_of(const Obstacle& obstacle);

/// True if people cannot walk beneath it.
bool blocks_people(const Obstacle& obstacle);

}  // namespace throng
