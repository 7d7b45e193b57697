// load_objects() returns the objects of the paper: the adult's loose parts.
// An object's origin is the centre of its smallest sphere; its position alone updates the sphere.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "avatars/mesh/mesh.h"
#include "culling/body_type.h"
#include "scenes/motion/box_motion.h"

namespace throng::paper {

struct Object {
  std::string name;                      ///< name of the part, such as "head"
  PartShape shape;                       ///< relative to the origin
  Mesh mesh;                             ///< the same shape, for pictures
  double radius_m;                       ///< encloses every point
  std::shared_ptr<const BodyType> type;  ///< the same shape, for culling
};

/// Returns the parts of a model in the order of its URDF; empty: the bundled adult. A model of one
/// part is repeated as often as the adult has parts. Throws InputError for a part without
/// triangles.
std::vector<Object> load_objects(const std::string& urdf = {});

/// Creates `count` objects from the parts in turn; every `static_every`-th is static (0: none).
BoxDynamics world_of(const std::vector<Object>& objects, size_t count, size_t static_every,
                     const BoxOptions& options);

/// Returns Part I's box. Its edge is calibrated for the adult and scales with the volume in which
/// the spheres of two objects overlap. Spheres then collide about as often as in the paper.
BoxOptions part_one_box(const std::vector<Object>& objects, uint64_t seed);

/// Returns the rounding margin of tests of these objects in a box.
float margin_m(const std::vector<Object>& objects, const BoxDynamics& world);

}  // namespace throng::paper
