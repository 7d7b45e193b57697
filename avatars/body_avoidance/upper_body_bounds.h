// UpperBodyBounds computes boxes around the upper body in any avoidance posture.
// Invariant: they contain every vertex of trunk, arms and head at any head yaw. The legs' bounds
// are stepping's, see WalkBounds.
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

  /// Kinematics of the upper body's links, for posture rows of the whole body.
  const FlatModel& kinematics() const { return kinematics_; }

  /// Returns a box around the upper body, or nothing if `all` does not contain it. `poses` are
  /// those of kinematics(), root frame, scale 1.
  std::optional<RootBox> box_within(std::span<const PartPose> poses, const RoundBounds& all,
                                    SimdTarget target) const;

  /// Boxes around parts in the frame of their link, and an ellipse in x and y that contains the
  /// part. Padded to a multiple of eight with the last part.
  struct Shapes {
    std::vector<uint32_t> link;  ///< index into the links of kinematics()
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
