#include "bench/paper/parts.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "culling/volumes/volumes.h"
#include "scenes/box/loose_parts.h"

namespace throng::paper {

std::vector<Object> load_objects(const std::string& urdf) {
  std::vector<Object> objects;
  for (const std::shared_ptr<const Model>& part :
       loose_parts(*load_model(urdf.empty() ? adult_urdf() : std::filesystem::path(urdf)))) {
    const Mesh& mesh = part->parts.front().mesh;
    PartShape shape{mesh.vertices, mesh.triangles};
    const double radius_m = reach_m(*part);
    // Rounded up, so that no point is left out.
    const RootSphere sphere{Eigen::Vector3f::Zero(),
                            std::nextafter(static_cast<float>(radius_m), 1e9f)};
    auto type = std::make_shared<BodyType>(std::vector<PartShape>{shape}, sphere, false);
    objects.push_back({part->name, std::move(shape), mesh, radius_m, std::move(type)});
  }
  return objects;
}

BoxWorld world_of(const std::vector<Object>& objects, size_t count, size_t static_every,
                  const BoxWorldOptions& options) {
  std::vector<double> radii_m;
  for (const Object& object : objects) radii_m.push_back(object.radius_m);
  return BoxWorld::of_kinds(options, radii_m, count, static_every);
}

BoxWorldOptions part_one_box(uint64_t seed) {
  BoxWorldOptions options;
  options.seed = seed;
  options.edge_m = 2.41;
  return options;
}

float margin_m(const std::vector<Object>& objects, const BoxWorld& world) {
  double radius_m = 0;
  for (const Object& object : objects) radius_m = std::max(radius_m, object.radius_m);
  return rounding_margin_m(static_cast<float>(2 * (world.reach_m() + radius_m)));
}

}  // namespace throng::paper
