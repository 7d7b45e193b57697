// Where the heads of people are: the centre of the head part's box, by forward kinematics of the
// joint angles that a frame has.
// One rule: whoever has a part called head has a head, also in a log, which does not say who is a
// person; anybody else is where the root is.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kinematics/kinematics.h"
#include "scenes/run/sink.h"

namespace throng {

class Heads {
 public:
  explicit Heads(const RunInfo& run);

  /// Seen from above, one an avatar, whether present or not. The frame has postures.
  void find(const RunInfo& run, const Frame& frame, std::span<Eigen::Vector2d> out);

 private:
  struct Kind {
    std::optional<FlatModel> kinematics;  ///< of the head alone; none: no head
    Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
    std::vector<uint32_t> avatars;
  };

  std::vector<Kind> kinds_;  ///< by model
  std::vector<const float*> rows_;
  std::vector<RootFrame> roots_;
  std::vector<PartPose> poses_;
};

}  // namespace throng
