// The room that an upper body takes, seen from above, wherever giving way has put it.
// One rule: it holds every vertex of trunk, arms and head, whichever way the head looks; the legs'
// room is stepping's, see WalkBounds.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "avatars/body_avoidance/outline.h"
#include "avatars/model/model.h"
#include "base/pose.h"
#include "base/simd.h"

namespace throng {

/// A sphere on the root's z axis and an upright cylinder around that axis.
struct RoundBounds {
  float sphere_z_m, sphere_m, cylinder_m;
};

class UpperBodyBounds {
 public:
  UpperBodyBounds(const Model& model, const AvoidanceColumns& columns);

  /// Poses the links of the upper body from posture rows of the whole.
  const FlatModel& kinematics() const { return kinematics_; }

  /// A box around the upper body in x, y and z; `poses` as kinematics() has them, root frame,
  /// scale 1. Nothing if `all` does not hold all of it.
  std::optional<RootBox> box_within(std::span<const PartPose> poses, const RoundBounds& all,
                                    SimdTarget target) const;

  /// Of parts, up to a multiple of eight, the last one repeated: a box in the frame of its link,
  /// and an ellipse across it that holds the part, too.
  struct Shapes {
    std::vector<uint32_t> link;  ///< of kinematics()
    std::vector<float> middle_m[3], half_m[3], ellipse_m[2];
  };

 private:
  struct UpperPart {
    const Part* part;
    bool turns;  ///< about the z axis of its link
  };
  static std::vector<UpperPart> upper_parts(const Model& model, const AvoidanceColumns& columns);
  UpperBodyBounds(const Model& model, const std::vector<UpperPart>& parts);
  void add(const UpperPart& part, uint32_t link);

  FlatModel kinematics_;
  Shapes shapes_;
};

}  // namespace throng
