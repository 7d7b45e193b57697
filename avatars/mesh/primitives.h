// Boxes, cylinders, spheres and capsules as closed meshes with outward triangles.
// One rule: the mesh encloses the true solid, so that no contact of it is missed.
#pragma once

#include "avatars/mesh/mesh.h"

namespace throng {

/// 8 vertices, 12 triangles, centred. Full edge lengths in metres.
Mesh box_mesh(const Eigen::Vector3d& size_m);

/// Along z, centred: a prism of 24 sides around the cylinder, its edges 0.9 % outside the radius.
Mesh cylinder_mesh(double radius_m, double length_m);

/// A cylinder along z with half a sphere at both ends, centred; `length_m` is the cylinder's. 24
/// sides and five rings an end, whose edges stand out by at most 2.1 % of the radius.
Mesh capsule_mesh(double radius_m, double length_m);

/// Centred: an icosahedron divided twice (162 vertices, 320 triangles) whose faces touch the
/// sphere; its corners stand out by about 2 %.
Mesh sphere_mesh(double radius_m);

}  // namespace throng
