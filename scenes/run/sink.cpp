#include "scenes/run/sink.h"

namespace throng {

void part_poses(const RunInfo& run, const Frame& frame, size_t avatar, std::span<PartPose> out) {
  const size_t first = frame.posture_offsets[avatar];
  const RootFrame root{frame.roots[avatar].world_from_root, run.scale_of_avatar[avatar]};
  forward_kinematics(run.models[run.model_of_avatar[avatar]]->kinematics,
                     frame.postures.subspan(first, frame.posture_offsets[avatar + 1] - first),
                     {&root, 1}, out);
}

}  // namespace throng
