// What names the content of a scene.
#include "base/hasher.h"
#include "scenes/file/scene.h"

namespace throng {

uint64_t content_hash_of(const Scene& scene) {
  Hasher hash;
  const auto add_area = [&](const Rectangle& r) {
    hash.add(r.min_m.x()).add(r.min_m.y()).add(r.max_m.x()).add(r.max_m.y());
  };
  const auto add_distribution = [&](const Distribution& d) {
    hash.add(d.mean).add(d.deviation).add(d.min).add(d.max);
  };
  hash.add(scene.name).add(scene.seed).add(scene.step_s);
  hash.add(name_of(scene.part_volume)).add(uint64_t{scene.exact});
  hash.add(uint64_t{scene.planted_feet});
  hash.add(name_of(scene.steering.model)).add(uint64_t{scene.steering.density_speed});
  add_area(scene.ground);
  hash.add(uint64_t{scene.groups.size()});
  for (const Group& group : scene.groups) {
    hash.add(group.name).add(static_cast<uint64_t>(group.count));
    hash.add(group.body == nullptr ? 0 : group.body->content_hash);
    add_area(group.spawn);
    hash.add(uint64_t{group.goals.size()});
    for (const Goal& goal : group.goals) {
      hash.add(uint64_t{goal.areas.size()});
      for (const Rectangle& area : goal.areas) add_area(area);
      hash.add(goal.wait_s).add(uint64_t{goal.pass});
    }
    hash.add(static_cast<uint64_t>(group.on_arrival));
    hash.add(uint64_t{group.sources.size()});
    for (const Source& source : group.sources) {
      add_area(source.area);
      hash.add(static_cast<uint64_t>(source.count)).add(source.rate_per_s).add(source.start_s);
      hash.add(uint64_t{source.random});
    }
    add_distribution(group.delay_s);
    add_distribution(group.speed_mps.value_or(age_group(Age::kAdult).speed_mps));
    add_distribution(group.height_m.value_or(age_group(Age::kAdult).height_m));
    if (group.ages != kAdultsOnly) {
      hash.add("ages").add(uint64_t{!group.speed_mps}).add(uint64_t{!group.height_m});
      for (const double share : group.ages) hash.add(share);
    }
    if (group.styles) {
      hash.add("styles");
      for (const double share : *group.styles) hash.add(share);
    }
    hash.add(group.radius_m);
    if (!group.driven.empty()) hash.add("driven").add(group.driven);
  }
  if (scene.box) {
    const PartsBox& box = *scene.box;
    hash.add("box").add(static_cast<uint64_t>(box.count)).add(box.edge_m);
    hash.add(static_cast<uint64_t>(box.static_every)).add(box.max_spin_radps);
    hash.add(box.min_speed_mps).add(box.max_speed_mps);
    hash.add(box.body == nullptr ? 0 : box.body->content_hash);
  }
  hash.add(uint64_t{scene.obstacles.size()});
  for (const Obstacle& obstacle : scene.obstacles) {
    hash.add(obstacle.name).add(static_cast<uint64_t>(obstacle.kind)).add(obstacle.heading_rad);
    for (int axis = 0; axis < 3; ++axis) hash.add(obstacle.centre_m[axis]);
    for (const Eigen::Vector3f& vertex : obstacle.mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) hash.add(static_cast<double>(vertex[axis]));
    for (const Eigen::Vector3i& triangle : obstacle.mesh.triangles)
      for (int corner = 0; corner < 3; ++corner) hash.add(static_cast<uint64_t>(triangle[corner]));
  }
  return hash.value();
}

}  // namespace throng
