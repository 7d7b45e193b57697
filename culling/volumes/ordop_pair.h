// The paper's or-DOP (slabs along the 13 directions as they are), one against one other, the
// directions of one as lanes: for who tests pair by pair and cannot collect pairs of the same
// parts. One rule: the answer is that of ordop_pair() below to the bit, on every target.
#pragma once

#include <array>
#include <cstddef>

#include "base/pose.h"
#include "culling/volumes/directions.h"
#include "culling/volumes/ordop_table.h"

namespace throng {

inline constexpr size_t kDirectionSlots = 16;  // 13 directions; the rest is padding

/// The directions of all k-DOPs as lanes; padding is the null vector.
struct alignas(64) DirectionLanes {
  float x[kDirectionSlots], y[kDirectionSlots], z[kDirectionSlots], length[kDirectionSlots];
};
inline constexpr DirectionLanes kDirectionLanes = [] {
  DirectionLanes lanes{};
  for (size_t i = 0; i < kDirections.size(); ++i) {
    lanes.x[i] = static_cast<float>(kDirections[i][0]);
    lanes.y[i] = static_cast<float>(kDirections[i][1]);
    lanes.z[i] = static_cast<float>(kDirections[i][2]);
    lanes.length[i] = direction_length(static_cast<int>(i));
  }
  return lanes;
}();

/// A part's or-DOP for ordop_pair: its slabs as lanes. Directions that a k-DOP of this k has not
/// are infinitely wide: they never separate.
struct alignas(64) OrdopLanes {
  OrdopLanes(const Slabs& fitted, int k);
  OrdopTable table;
  float centre[kDirectionSlots], half[kDirectionSlots];
};

/// One or-DOP ("own") against another ("other"), in units of own's scale.
struct OrdopHalf {
  float other_from_own[3][3];  ///< times other's scale over own's
  float offset[3];             ///< of other's centre, in own's frame
  float margin;
};

/// Both halves of a test. `shift_m`: root of b minus root of a, then the margin for rounding.
struct OrdopHalves {
  OrdopHalves(const OrdopTable& a, const PartPose& pose_a, float scale_a, const OrdopTable& b,
              const PartPose& pose_b, float scale_b, const float (&shift_m)[4]);
  OrdopHalf from_a, from_b;
};

/// The scalar reference.
template <int K>
bool ordop_pair(const OrdopLanes& a, const PartPose& pose_a, float scale_a, const OrdopLanes& b,
                const PartPose& pose_b, float scale_b, const float (&shift_m)[4]);

}  // namespace throng
