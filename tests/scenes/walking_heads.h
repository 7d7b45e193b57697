// Recorded heads of people who walk by the gait, as cameras see them. They come from forward
// kinematics of whole postures, not from the tables of HeadOffset.
#pragma once

#include <algorithm>
#include <vector>

#include "avatars/model/model.h"
#include "scenes/run/posing.h"
#include "scenes/run/sink.h"

namespace throng {

/// Horizontal position of the centre of a head.
inline Eigen::Vector2d head_of(const Model& model, const Frame& frame, const BodyStates& bodies,
                               size_t id) {
  std::vector<PartPose> poses(static_cast<size_t>(model.part_count()));
  const RootFrame root{frame.roots[id].world_from_root, bodies.scales[id]};
  const size_t begin = frame.posture_offsets[id], end = frame.posture_offsets[id + 1];
  forward_kinematics(model.kinematics, frame.postures.subspan(begin, end - begin), {&root, 1},
                     poses);
  const auto head = std::find_if(model.parts.begin(), model.parts.end(),
                                 [](const Part& part) { return part.name == "head"; });
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : head->mesh.vertices) box.extend(vertex);
  const Eigen::Vector3d middle =
      static_cast<double>(bodies.scales[id]) * box.center().cast<double>();
  const PartPose& pose = poses[static_cast<size_t>(head - model.parts.begin())];
  return (frame.roots[id].position_m + to_isometry(pose) * middle).head<2>();
}

}  // namespace throng
