#include "scenes/run/kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/errors.h"
#include "base/limits.h"
#include "scenes/file/scene_limits.h"
#include "scenes/run/drive.h"

namespace throng {
namespace {

/// A sphere in float must still hold points that rounding moved by an ulp of 10 km.
constexpr float kSphereSlack_m = 1e-3f;
static_assert(BodyType::kMaxParts == kMaxModelParts);
static_assert(kMaxModels + kMaxObstacles <= UINT16_MAX, "types of bodies are 16 bits");

}  // namespace

Kinds kinds_of(const Scene& scene) {
  Kinds kinds;
  std::vector<const Model*> walking;  // by kind; null for a driven one, whose bounds are its own
  for (const Group& group : scene.groups) {
    if (group.body->part_count() < 1 || group.body->part_count() > BodyType::kMaxParts)
      throw InputError(group.model.string(),
                       fmt::format("a model of 1 to {} parts", BodyType::kMaxParts),
                       fmt::format("{}", group.body->part_count()));
    auto kind = walking.end();
    if (group.driven.empty()) kind = std::find(walking.begin(), walking.end(), group.body.get());
    kinds.of_group.push_back(static_cast<uint16_t>(kind - walking.begin()));
    if (kind != walking.end()) continue;
    if (static_cast<int64_t>(kinds.models.size()) >= kMaxModels)
      throw InputError(scene.file.string(),
                       fmt::format("at most {} models, one for each driven group", kMaxModels),
                       "more");
    walking.push_back(group.driven.empty() ? group.body.get() : nullptr);
    kinds.models.push_back(group.body);
  }
  return kinds;
}

RootSphere driven_sphere(const Model& model) {
  const float reach_m = reach_of(model) + kSphereSlack_m;
  return {Eigen::Vector3f::Zero(), reach_m, reach_m};
}

std::shared_ptr<const BodyType> body_type(const Model& model, const RootSphere& sphere) {
  std::vector<PartShape> shapes;
  for (const Part& part : model.parts) shapes.push_back({part.mesh.vertices, part.mesh.triangles});
  return std::make_shared<BodyType>(std::move(shapes), sphere, false);
}

std::shared_ptr<const BodyType> obstacle_type(const Obstacle& obstacle) {
  const std::vector<Eigen::Vector3f>& points = obstacle.mesh.vertices;
  Eigen::Vector3f low = points.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  RootSphere sphere{0.5f * (low + high), 0};
  for (const Eigen::Vector3f& point : points)
    sphere.radius_m = std::max(sphere.radius_m, (point - sphere.centre_m).norm());
  sphere.radius_m += kSphereSlack_m;
  return std::make_shared<BodyType>(std::vector<PartShape>{{points, obstacle.mesh.triangles}},
                                    sphere, true);
}

}  // namespace throng
