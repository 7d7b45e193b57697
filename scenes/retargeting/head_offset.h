// HeadOffset tabulates the horizontal offset of the head of a walking body from its root.
// It is the centre of the head's box as the gait poses it, regardless of the legs.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "avatars/gait/gait.h"
#include "avatars/model/model.h"

namespace throng {

class HeadOffset {
 public:
  HeadOffset() = default;
  /// Tabulates one gait of a model. Without a part named "head" the offset is zero.
  HeadOffset(const Model& model, const Gait& gait);

  bool has_head() const { return !nodes_m_.empty(); }

  /// Offset of the head from the root on the ground plane, in metres and the root frame.
  /// `phase`: in [0, 1). `speed_mps`: gait speed. `scale`: scale of the body.
  Eigen::Vector2f offset_m(float phase, float speed_mps, float scale) const;

  /// Gait phase at which the head is farthest to the left, in [0, 1).
  float leftmost_phase(float speed_mps, float scale) const;

 private:
  static constexpr int kPhases = 32;
  static constexpr int kSpeeds = 25;
  static constexpr float kSpeedCell_mps = 0.125f;

  std::vector<Eigen::Vector2f> nodes_m_;  ///< speed-major, the first phase repeated at the end
  std::vector<float> leftmost_;           ///< indexed by speed, unwrapped
};

}  // namespace throng
