// Body kinds are the models of a scene's groups and their bounds for culling.
// Invariant: a kind's sphere holds every posture that its bodies can take.
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

struct Kinds {
  std::vector<std::shared_ptr<const Model>> models;
  std::vector<uint16_t> of_group;
};

/// Kinds of a scene's groups. Walking groups with equal models share a kind; an externally
/// controlled group has its own, because its bounds differ. Throws InputError for a model without
/// parts or with too many.
Kinds kinds_of(const Scene& scene);

/// Sphere around all postures within the joint limits.
RootSphere any_posture_sphere(const Model& model);

/// Range of values in a column of posture rows; initially empty.
struct ColumnSpan {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};
/// Sphere around all postures with columns within `spans`: one non-empty span per column.
RootSphere sphere_around(const Model& model, std::span<const ColumnSpan> spans);

std::shared_ptr<const BodyType> body_type(const Model& model, const RootSphere& sphere,
                                          const PartVolumes& volumes);
std::shared_ptr<const BodyType> obstacle_type(const Obstacle& obstacle);

}  // namespace throng
