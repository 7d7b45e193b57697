#include "scenes/motion/parts_world.h"

#include "scenes/motion/loose_parts.h"
#include "scenes/run/posing.h"
#include "scenes/run/sink.h"

namespace throng {
namespace {

BoxWorld box_of(const Scene& scene, std::span<const std::shared_ptr<const Model>> parts) {
  const PartsBox& box = *scene.box;
  std::vector<double> radii_m;
  for (const std::shared_ptr<const Model>& part : parts) radii_m.push_back(reach_m(*part));
  BoxWorldOptions options;
  options.seed = scene.seed;
  if (!scene.file.empty()) options.name = scene.file.string();
  options.edge_m = box.edge_m;
  options.step_s = scene.step_s;
  options.min_speed_mps = box.min_speed_mps;
  options.max_speed_mps = box.max_speed_mps;
  options.max_spin_radps = box.max_spin_radps;
  return BoxWorld::of_kinds(options, radii_m, static_cast<size_t>(box.count),
                            static_cast<size_t>(box.static_every));
}

}  // namespace

PartsWorld::PartsWorld(const Scene& scene)
    : parts_(loose_parts(*scene.box->body)), box_(box_of(scene, parts_)) {}

void PartsWorld::place(BodyStates& bodies) {
  for (size_t i = 0; i < box_.size(); ++i) {
    bodies.types.push_back(static_cast<uint16_t>(i % parts_.size()));
    bodies.scales.push_back(1);
    bodies.phases.push_back(0);
  }
}

void PartsWorld::describe(RunInfo& info) const {
  info.groups = {"part"};
  info.group_of_avatar.assign(box_.size(), 0);
  info.drive_channels.resize(1);
}

void PartsWorld::update(const Posing&, BodyStates& bodies, std::span<float> speeds_mps) {
  for (size_t i = 0; i < box_.size(); ++i) {
    bodies.roots[i] = {box_.positions_m()[i], box_.orientations()[i].cast<float>()};
    speeds_mps[i] = static_cast<float>(box_.velocities_mps()[i].norm());
  }
}

}  // namespace throng
