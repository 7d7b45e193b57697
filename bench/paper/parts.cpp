#include "bench/paper/parts.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "avatars/model.h"
#include "culling/volumes.h"

namespace throng::paper {
namespace {

/// Table 1, as far as the adult's file names go with it.
constexpr std::array<std::string_view, 15> kTable1 = {
    "head",          "torso",        "pelvis",        "upperRightLeg", "upperLeftLeg",
    "lowerRightLeg", "lowerLeftLeg", "leftFoot",      "rightFoot",     "upperLeftArm",
    "upperRightArm", "lowerLeftArm", "lowerRightArm", "leftHand",      "RightHand"};

size_t rank_of(const Part& part) {
  const std::string stem = part.source.substr(0, part.source.find('.'));
  return static_cast<size_t>(std::find(kTable1.begin(), kTable1.end(), stem) - kTable1.begin());
}

Object centred(const Part& part) {
  Object object;
  object.name = part.source.substr(0, part.source.find('.'));
  object.mesh = part.mesh;
  const Eigen::Vector3f centre = Sphere::fit(part.mesh.vertices).centre_m;
  double radius_m = 0;
  for (Eigen::Vector3f& vertex : object.mesh.vertices) {
    vertex -= centre;
    radius_m = std::max(radius_m, vertex.cast<double>().norm());
  }
  object.radius_m = radius_m;
  object.shape = {object.mesh.vertices, object.mesh.triangles};
  return object;
}

}  // namespace

std::vector<Object> load_objects() {
  const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  std::vector<const Part*> parts;
  for (const Part& part : adult->parts) parts.push_back(&part);
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part* a, const Part* b) { return rank_of(*a) < rank_of(*b); });
  std::vector<Object> objects;
  for (const Part* part : parts) objects.push_back(centred(*part));
  return objects;
}

BoxWorld world_of(const std::vector<Object>& objects, size_t count, size_t static_every,
                  const BoxWorldOptions& options) {
  std::vector<double> radii_m(count);
  std::vector<uint8_t> is_static(count);
  for (size_t i = 0; i < count; ++i) {
    radii_m[i] = objects[i % objects.size()].radius_m;
    is_static[i] = static_every != 0 && i % static_every == static_every - 1;
  }
  return BoxWorld(options, radii_m, is_static);
}

float margin_m(const std::vector<Object>& objects, const BoxWorld& world) {
  double radius_m = 0;
  for (const Object& object : objects) radius_m = std::max(radius_m, object.radius_m);
  return rounding_margin_m(static_cast<float>(2 * (world.reach_m() + radius_m)));
}

}  // namespace throng::paper
