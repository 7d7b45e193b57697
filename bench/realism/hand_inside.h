// Whether a hand is wholly inside a part of somebody else.
// One rule: every vertex of the hand is asked for, until one is outside.
#pragma once

#include <vector>

#include "culling/exact/triangle_bvh.h"
#include "scenes/run/sink.h"

namespace throng::realism {

class HandInside {
 public:
  explicit HandInside(const RunInfo& run);

  /// Of a pair of which one part or both are hands; false for any other. The frame has postures.
  bool is_inside(const RunInfo& run, const Frame& frame, PairKey pair);

  /// The least edge of the hand's box at this avatar's scale; of two hands the lesser. Infinite for
  /// a pair without hands: nothing is deeper.
  double thickness_m(const RunInfo& run, PairKey pair) const;

 private:
  struct Solid {
    bool is_hand = false;
    float thickness_m = 0;
    std::vector<Eigen::Vector3f> corners;  ///< a hand's vertices, those of its hull first
    std::unique_ptr<TriangleBvh> surface;
  };
  struct Placed {
    const Solid* solid;
    Eigen::Isometry3d world_from_part;  ///< but for the place of the first root
    double scale;
  };
  const Solid& solid(const RunInfo& run, uint32_t avatar, uint32_t part) const;
  Placed placed(const RunInfo& run, const Frame& frame, uint32_t avatar, uint32_t part,
                const Eigen::Vector3d& origin_m);
  static bool holds(const Placed& outer, const Placed& hand);

  std::vector<std::vector<Solid>> solids_;  ///< by model and part
  std::vector<PartPose> poses_;
};

}  // namespace throng::realism
