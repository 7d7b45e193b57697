// The 15 objects of the paper: the adult's loose parts.
// One rule: an object's origin is the middle of its smallest sphere, so that the sphere is updated
// by the position alone.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "avatars/mesh/mesh.h"
#include "culling/body_type.h"
#include "scenes/motion/box_motion.h"

namespace throng::paper {

struct Object {
  std::string name;                      ///< the part's, "head"
  PartShape shape;                       ///< about the origin
  Mesh mesh;                             ///< the same, for pictures
  double radius_m;                       ///< every point lies within
  std::shared_ptr<const BodyType> type;  ///< the same for culling
};

/// The parts of a model, in the order of its URDF; the bundled adult's if none is named. Of a model
/// of one part as many copies as the adult has parts. Throws InputError if one has no triangles.
std::vector<Object> load_objects(const std::string& urdf = {});

/// `count` objects, the parts in turn; every `static_every`-th stands still (0: none does).
BoxDynamics world_of(const std::vector<Object>& objects, size_t count, size_t static_every,
                     const BoxOptions& options);

/// Part I's box. Its edge is calibrated on the adult, and in proportion to the room in which the
/// spheres of other objects collide: they then do about as often as in the paper.
BoxOptions part_one_box(const std::vector<Object>& objects, uint64_t seed);

/// What tests over these objects in a box must allow for rounding.
float margin_m(const std::vector<Object>& objects, const BoxDynamics& world);

}  // namespace throng::paper
