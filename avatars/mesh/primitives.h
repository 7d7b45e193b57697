// Primitive meshes: boxes, cylinders, spheres and capsules, closed and oriented outwards.
// Invariant: the mesh encloses the true solid; no contact of the solid is missed.
#pragma once

#include <vector>

#include "avatars/mesh/mesh.h"

namespace throng {

/// Centred box with 8 vertices and 12 triangles. `size_m`: full edge lengths.
Mesh box_mesh(const Eigen::Vector3d& size_m);

/// Centred cylinder along z: a circumscribed prism of 24 sides with edges 0.9 % outside the radius.
Mesh cylinder_mesh(double radius_m, double length_m);

/// Prism over a convex ring, counter-clockwise, centred along z.
Mesh prism_mesh(const std::vector<Eigen::Vector2d>& ring_m, double height_m);

/// Centred capsule along z; `length_m` is that of the cylinder between the half spheres. 24 sides
/// and five rings per end, with edges at most 2.1 % of the radius outside.
Mesh capsule_mesh(double radius_m, double length_m);

/// Centred sphere: an icosahedron divided twice (162 vertices, 320 triangles). Its faces touch the
/// sphere; its corners are about 2 % outside.
Mesh sphere_mesh(double radius_m);

}  // namespace throng
