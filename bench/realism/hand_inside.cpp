#include "bench/realism/hand_inside.h"

#include <algorithm>
#include <limits>

#include "analysis/measures/part_group.h"
#include "culling/distance/hull_depth.h"
#include "scenes/run/sink.h"

namespace throng::realism {

HandInside::HandInside(const RunInfo& run) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    std::vector<Solid>& solids = solids_.emplace_back();
    for (const Part& part : model->parts) {
      Solid& solid = solids.emplace_back();
      if (!part.mesh.triangles.empty())
        solid.surface = std::make_unique<TriangleBvh>(part.mesh.vertices, part.mesh.triangles);
      solid.is_hand = part_group(part.name) == PartGroup::kHand;
      if (!solid.is_hand) continue;
      Eigen::AlignedBox3f box;
      for (const Eigen::Vector3f& vertex : part.mesh.vertices) box.extend(vertex);
      solid.thickness_m = box.sizes().minCoeff();
      const ConvexHull hull(part.mesh.vertices);
      for (Eigen::Index i = 0; i < hull.points().rows(); ++i)
        solid.corners.emplace_back(hull.points().row(i).transpose().cast<float>());
    }
  }
}

const HandInside::Solid& HandInside::solid(const RunInfo& run, uint32_t avatar,
                                           uint32_t part) const {
  return solids_[run.model_of_avatar[avatar]][part];
}

double HandInside::thickness_m(const RunInfo& run, PairKey pair) const {
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& [avatar, part] :
       {std::pair(pair.a(), pair.part_a()), std::pair(pair.b(), pair.part_b())})
    if (const Solid& one = solid(run, avatar, part); one.is_hand)
      least_m =
          std::min(least_m, static_cast<double>(one.thickness_m * run.scale_of_avatar[avatar]));
  return least_m;
}

HandInside::Placed HandInside::placed(const RunInfo& run, const Frame& frame, uint32_t avatar,
                                      uint32_t part, const Eigen::Vector3d& origin_m) {
  const Model& model = *run.models[run.model_of_avatar[avatar]];
  poses_.resize(model.parts.size());
  part_poses(run, frame, avatar, poses_);
  Eigen::Isometry3d world_from_part = to_isometry(poses_[part]);
  world_from_part.pretranslate(frame.roots[avatar].position_m - origin_m);
  return {&solid(run, avatar, part), world_from_part,
          static_cast<double>(run.scale_of_avatar[avatar])};
}

bool HandInside::holds(const Placed& outer, const Placed& hand) {
  if (!hand.solid->is_hand || outer.solid->surface == nullptr) return false;
  const Eigen::Isometry3d outer_from_hand = outer.world_from_part.inverse() * hand.world_from_part;
  return std::all_of(
      hand.solid->corners.begin(), hand.solid->corners.end(), [&](const Eigen::Vector3f& corner) {
        return outer.solid->surface->contains(outer_from_hand *
                                              (hand.scale * corner.cast<double>()) / outer.scale);
      });
}

bool HandInside::is_inside(const RunInfo& run, const Frame& frame, PairKey pair) {
  if (!solid(run, pair.a(), pair.part_a()).is_hand && !solid(run, pair.b(), pair.part_b()).is_hand)
    return false;
  const Eigen::Vector3d& origin_m = frame.roots[pair.a()].position_m;
  const Placed a = placed(run, frame, pair.a(), pair.part_a(), origin_m);
  const Placed b = placed(run, frame, pair.b(), pair.part_b(), origin_m);
  return holds(a, b) || holds(b, a);
}

}  // namespace throng::realism
