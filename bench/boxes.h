// The boxes that every engine is given, and the pairs that every engine has to list.
// One rule: computed outside of anybody's time, by loops simple enough to trust.
#pragma once

#include <vector>

#include "bench/crowd.h"
#include "bench/engines/engine.h"
#include "culling/culling.h"

namespace throng::bench {

/// The tight boxes of all parts of a crowd: the boxes of their placed vertices.
class CrowdBoxes {
 public:
  CrowdBoxes(const Crowd& crowd, std::shared_ptr<const BodyType> type)
      : crowd_(crowd), type_(std::move(type)) {}

  /// The boxes of the crowd as it stands now; valid until the next call.
  BoxList compute();

  /// Poses of all parts, avatar-major, as of the last compute().
  const std::vector<PartPose>& poses() const { return poses_; }

 private:
  const Crowd& crowd_;
  std::shared_ptr<const BodyType> type_;
  std::vector<PartPose> poses_;
  std::vector<Box> boxes_;
};

/// All overlapping pairs of boxes of different avatars, sorted: avatars by a grid as wide as the
/// widest of them, then every part against every part.
std::vector<BoxPair> reference_pairs(const BoxList& frame);

}  // namespace throng::bench
