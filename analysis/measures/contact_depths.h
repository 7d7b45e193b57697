// How deep the parts of people who touch are in each other, at one instant.
// One rule: triangles decided that they touch; hulls only say how far.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "culling/distance/hull_depth.h"
#include "scenes/run/sink.h"

namespace throng {

class ContactDepths {
 public:
  explicit ContactDepths(const RunInfo& run);

  /// Calls found(pair, depth in m) for every pair of parts of two people that touch now. The frame
  /// has postures.
  void find(const RunInfo& run, const Frame& frame,
            const std::function<void(PairKey, double)>& found);

 private:
  const PartPose* poses_of(const RunInfo& run, const Frame& frame, uint32_t avatar);

  std::vector<std::vector<ConvexHull>> hulls_;  ///< by model and part
  std::vector<size_t> first_pose_;              ///< by avatar, of this frame; kNone: not posed
  std::vector<PartPose> poses_;
  DepthFinder finder_;
};

}  // namespace throng
