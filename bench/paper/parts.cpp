#include "bench/paper/parts.h"

#include <algorithm>

#include "culling/volumes.h"
#include "scenes/loose_parts.h"

namespace throng::paper {

std::vector<Object> load_objects() {
  std::vector<Object> objects;
  for (const std::shared_ptr<const Model>& part : loose_parts(*load_model(adult_urdf()))) {
    const Mesh& mesh = part->parts.front().mesh;
    objects.push_back({part->name, {mesh.vertices, mesh.triangles}, mesh, reach_m(*part)});
  }
  return objects;
}

BoxWorld world_of(const std::vector<Object>& objects, size_t count, size_t static_every,
                  const BoxWorldOptions& options) {
  std::vector<double> radii_m;
  for (const Object& object : objects) radii_m.push_back(object.radius_m);
  return BoxWorld::of_kinds(options, radii_m, count, static_every);
}

float margin_m(const std::vector<Object>& objects, const BoxWorld& world) {
  double radius_m = 0;
  for (const Object& object : objects) radius_m = std::max(radius_m, object.radius_m);
  return rounding_margin_m(static_cast<float>(2 * (world.reach_m() + radius_m)));
}

}  // namespace throng::paper
