// The kinds of bodies of a scene: models of its groups, and what culling knows of each kind.
// One rule: a sphere holds every posture that its kind can take.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "avatars/gait/gait.h"
#include "avatars/model/model.h"
#include "culling/body_type.h"
#include "scenes/file/scene.h"

namespace throng {

/// The kinds of avatars: models, and which of them each group has.
struct Kinds {
  std::vector<std::shared_ptr<const Model>> models;
  std::vector<uint16_t> of_group;
};

/// The kinds of a scene's groups. Groups that walk with the same model share a kind; a driven group
/// has its own, for its bounds are its own. Throws InputError if a model has no parts or too many.
Kinds kinds_of(const Scene& scene);

/// Around every posture at all.
RootSphere any_posture_sphere(const Model& model);

/// The values of a column of posture rows; none yet.
struct ColumnSpan {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};
/// Around every posture whose columns are within `spans`, one a column, none of them empty.
RootSphere sphere_around(const Model& model, std::span<const ColumnSpan> spans);

std::shared_ptr<const BodyType> body_type(const Model& model, const RootSphere& sphere,
                                          const PartVolumes& volumes);
std::shared_ptr<const BodyType> obstacle_type(const Obstacle& obstacle);

}  // namespace throng
