// The room that an upper body takes, seen from above, wherever giving way has put it.
// One rule: it holds every vertex of trunk, arms and head, whichever way the head looks; the legs'
// room is stepping's, see WalkRoom.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "avatars/model/model.h"
#include "avatars/yielding/outline.h"
#include "base/pose.h"

namespace throng {

class UpperRoom {
 public:
  UpperRoom(const Model& model, const YieldColumns& columns);

  /// A box around the upper body in x, y and z; `poses` of all parts of the model, root frame,
  /// scale 1. Nothing if a sphere on the root's z axis and an upright cylinder around it do not
  /// hold all of it.
  std::optional<RootBox> box_within(std::span<const PartPose> poses, float sphere_z_m,
                                    float sphere_m, float cylinder_m) const;

 private:
  /// A part's box in its link's frame, and an ellipse across it that holds the part, too.
  struct Shape {
    uint32_t part;
    float middle_m[3], half_m[3];
    float ellipse_m[2];
  };
  struct Extent {
    float low_m[3], high_m[3];
  };
  static Shape around(const Part& part, uint32_t index, bool turns);
  static Extent extent_of(const Shape& shape, const PartPose& pose);

  std::vector<Shape> shapes_;
};

}  // namespace throng
