#include "bench/paper/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "base/errors.h"
#include "culling/volumes/volumes.h"
#include "scenes/motion/box_motion.h"

namespace throng::paper {

namespace {

constexpr double kAdultEdge_m = 2.41;
constexpr size_t kCopies = 15;

/// Mean volume in which the spheres of two objects overlap, up to a constant factor.
double sphere_overlap_volume_m3(const std::vector<Object>& objects) {
  double sum_m3 = 0;
  size_t pairs = 0;
  for (size_t a = 0; a < objects.size(); ++a)
    for (size_t b = a + 1; b < objects.size(); ++b, ++pairs)
      sum_m3 += std::pow(objects[a].radius_m + objects[b].radius_m, 3);
  return sum_m3 / static_cast<double>(pairs);
}

}  // namespace

std::vector<Object> load_objects(const std::string& urdf) {
  std::vector<Object> objects;
  for (const std::shared_ptr<const Model>& part :
       loose_parts(*load_model(urdf.empty() ? adult_urdf() : std::filesystem::path(urdf)))) {
    const Mesh& mesh = part->parts.front().mesh;
    if (mesh.is_point_cloud())
      throw InputError(urdf, "triangles in every part", fmt::format("none in '{}'", part->name));
    PartShape shape{mesh.vertices, mesh.triangles};
    const double radius_m = reach_m(*part);
    // Rounded up, to include every point.
    const RootSphere sphere{Eigen::Vector3f::Zero(),
                            std::nextafter(static_cast<float>(radius_m), 1e9f)};
    auto type = std::make_shared<BodyType>(std::vector<PartShape>{shape}, sphere, false);
    objects.push_back({part->name, std::move(shape), mesh, radius_m, std::move(type)});
  }
  if (objects.size() == 1) objects.resize(kCopies, Object(objects.front()));
  return objects;
}

BoxDynamics world_of(const std::vector<Object>& objects, size_t count, size_t static_every,
                     const BoxOptions& options) {
  std::vector<double> radii_m;
  for (const Object& object : objects) radii_m.push_back(object.radius_m);
  return BoxDynamics::of_kinds(options, radii_m, count, static_every);
}

BoxOptions part_one_box(const std::vector<Object>& objects, uint64_t seed) {
  static const double adult_overlap_volume_m3 = sphere_overlap_volume_m3(load_objects());
  BoxOptions options;
  options.seed = seed;
  options.edge_m =
      kAdultEdge_m * std::cbrt(sphere_overlap_volume_m3(objects) / adult_overlap_volume_m3);
  return options;
}

float margin_m(const std::vector<Object>& objects, const BoxDynamics& world) {
  double radius_m = 0;
  for (const Object& object : objects) radius_m = std::max(radius_m, object.radius_m);
  return rounding_margin_m(static_cast<float>(2 * (world.reach_m() + radius_m)));
}

}  // namespace throng::paper
