#include "analysis/measures/contact_depths.h"

#include <algorithm>

#include "scenes/run/sink.h"

namespace throng {
namespace {

constexpr size_t kNoPose = SIZE_MAX;

}  // namespace

ContactDepths::ContactDepths(const RunInfo& run)
    : first_pose_(run.model_of_avatar.size(), kNoPose) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    std::vector<ConvexHull>& hulls = hulls_.emplace_back();
    for (const Part& part : model->parts) hulls.emplace_back(part.mesh.vertices);
  }
}

const PartPose* ContactDepths::poses_of(const RunInfo& run, const Frame& frame, uint32_t avatar) {
  if (first_pose_[avatar] == kNoPose) {
    const Model& model = *run.models[run.model_of_avatar[avatar]];
    first_pose_[avatar] = poses_.size();
    poses_.resize(poses_.size() + model.parts.size());
    part_poses(run, frame, avatar, std::span(poses_).subspan(first_pose_[avatar]));
  }
  return poses_.data() + first_pose_[avatar];
}

void ContactDepths::find(const RunInfo& run, const Frame& frame,
                         const std::function<void(PairKey, double)>& found) {
  std::fill(first_pose_.begin(), first_pose_.end(), kNoPose);
  poses_.clear();
  for (const PairKey& pair : frame.pairs) {
    if (pair.b() >= first_pose_.size() || pair.part_a() == kWholeBody) continue;
    poses_of(run, frame, pair.a());  // may move the poses of the other
    const PartPose* of_b = poses_of(run, frame, pair.b()) + pair.part_b();
    const PartPose* of_a = poses_of(run, frame, pair.a()) + pair.part_a();
    const ConvexHull& hull_a = hulls_[run.model_of_avatar[pair.a()]][pair.part_a()];
    const ConvexHull& hull_b = hulls_[run.model_of_avatar[pair.b()]][pair.part_b()];
    const Eigen::Vector3f shift =
        (frame.roots[pair.b()].position_m - frame.roots[pair.a()].position_m).cast<float>();
    found(pair, finder_
                    .depth({&hull_a, of_a, run.scale_of_avatar[pair.a()]},
                           {&hull_b, of_b, run.scale_of_avatar[pair.b()]}, shift)
                    .depth_m);
  }
}

}  // namespace throng
