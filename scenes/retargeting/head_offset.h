// Where the head of a walking body is, seen from above: what hangs a body below a recorded head.
// One rule: it is the middle of the head's box as the gait poses it, whatever the legs do.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "avatars/gait/gait.h"
#include "avatars/model/model.h"

namespace throng {

class HeadOffset {
 public:
  HeadOffset() = default;
  /// Tabulates one gait of a model. A model without a part named "head" has none: its place is
  /// that of the root.
  HeadOffset(const Model& model, const Gait& gait);

  bool has_head() const { return !nodes_m_.empty(); }

  /// From the root to the head on the ground plane, in the root frame (metres), of a body of this
  /// scale; phase in [0, 1), speed of the gait.
  Eigen::Vector2f offset_m(float phase, float speed_mps, float scale) const;

  /// In which phase of this gait the head is farthest to the left; in [0, 1).
  float leftmost_phase(float speed_mps, float scale) const;

 private:
  static constexpr int kPhases = 32;
  static constexpr int kSpeeds = 25;
  static constexpr float kSpeedCell_mps = 0.125f;  ///< at scale 1

  std::vector<Eigen::Vector2f> nodes_m_;  ///< speed-major, the first phase repeated at the end
  std::vector<float> leftmost_;           ///< by speed, without turns
};

}  // namespace throng
