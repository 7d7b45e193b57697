#include "culling/stages/shared_stages.h"

#include <algorithm>

namespace throng {
namespace {

std::vector<VolumeKind> volumes_of(BodyTypes types, VolumeKind volume) {
  std::vector<VolumeKind> out;
  for (const auto& type : types)
    for (const PartShape& part : type->parts()) out.push_back(part.volume.value_or(volume));
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

SharedStages::SharedStages(BodyTypes types, const CullerOptions& options, Workers& workers,
                           const Margins& margins)
    : types_(types),
      kernels_(kernels_for(options.simd)),
      volume_(options.part_volume),
      volumes_(volumes_of(types, volume_)),
      exact_(options.exact),
      filter_(options.filter),
      slots_(types),
      broad_(types, kernels_, workers, options.pair_search, filter_, margins) {
  if (volumes_.size() == 1) volume_ = volumes_.front();
  size_t shapes = 0;
  for (size_t type = 0; type < types.size(); ++type) {
    fit_for_mid_phase(*types[type], volumes_, exact_);
    const size_t parts = static_cast<size_t>(types[type]->part_count());
    type_parts_.push_back(static_cast<uint16_t>(parts));
    type_first_shape_.push_back(static_cast<uint16_t>(std::min(shapes, size_t{kMaxBucketShapes})));
    shapes += parts;
    while (shape_type_.size() < std::min(shapes, size_t{kMaxBucketShapes}))
      shape_type_.push_back(static_cast<uint16_t>(type));
  }
}

void SharedStages::count(const MidPhaseCounters& parts, const PosedBodies::Counters& posed,
                         CullingCounters& counters) const {
  counters.body_sphere = broad_.counters();
  counters.body_box = parts.body_box;
  counters.body_box.volume = "aabb";
  counters.body_box.tests += broad_.apart_by_bounds();
  counters.body_box.updates = posed.bodies;
  counters.part_box = parts.part_box;
  counters.part_box.volume = "aabb";
  counters.part_box.updates = posed.parts;
  counters.part_box.update_ns = posed.box_ns;
  counters.part_volume = parts.part_volume;
  counters.part_volume.volume = volumes_.size() > 1 ? "mixed" : name_of(volume_);
  counters.part_volume.updates += posed.parts;
  counters.part_volume.update_ns += posed.pose_ns;
  counters.triangles = parts.triangles;
  counters.triangles.volume = exact_ ? "triangles" : "off";
  counters.primitive_tests = parts.primitive_tests;
  counters.posed_bodies = posed.bodies;
  counters.pose_ns = posed.pose_ns;
}

}  // namespace throng
