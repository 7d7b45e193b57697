#include "scenes/motion/loose_parts.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "base/hasher.h"
#include "culling/volumes/sphere.h"

namespace throng {
namespace {

std::shared_ptr<const Model> alone(const Model& body, const Part& part) {
  Robot robot;
  robot.name = part.name;
  robot.links.push_back({part.name, {}, {}, {}});
  Part centred{part.name, part.source, 0, part.mesh};
  const Eigen::Vector3f middle = Sphere::fit(part.mesh.vertices).centre_m;
  for (Eigen::Vector3f& vertex : centred.mesh.vertices) vertex -= middle;
  const std::array<int, 1> links = {0};
  FlatModel kinematics(robot, links);
  Model model{part.name,
              std::move(robot),
              {std::move(centred)},
              std::move(kinematics),
              0,
              Hasher().add(body.content_hash).add(std::string_view(part.name)).value()};
  model.height_m = static_cast<float>(2 * reach_m(model));
  return std::make_shared<const Model>(std::move(model));
}

}  // namespace

std::vector<std::shared_ptr<const Model>> loose_parts(const Model& body) {
  std::vector<std::shared_ptr<const Model>> models;
  for (const Part& part : body.parts) models.push_back(alone(body, part));
  return models;
}

double reach_m(const Model& loose_part) {
  double reach = 0;
  for (const Eigen::Vector3f& vertex : loose_part.parts.front().mesh.vertices)
    reach = std::max(reach, vertex.cast<double>().norm());
  return reach;
}

}  // namespace throng
