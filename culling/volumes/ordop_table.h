// OrdopTable stores an or-DOP in the layout of the kernels that test it. It is immutable.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "base/pose.h"
#include "culling/volumes/slabs.h"

namespace throng {

/// or-DOP of a part, for lookup by the sign bits of a direction (bit 0: x negative, ...). Slabs are
/// those of the points (p - origin) / half_box, in units of the part's box. Edge and corner planes
/// then cut a long box like a cube: a quarter fewer false positives than unscaled directions. The
/// three axis slabs have centre zero and drop out of every sum.
struct alignas(64) OrdopTable {
  /// `points`: at least one.
  explicit OrdopTable(std::span<const Eigen::Vector3f> points);
  /// The paper's or-DOP: slabs as fitted, recentred but in metres (half_box 1).
  explicit OrdopTable(const Slabs& fitted);
  // Eight corners by sign bits, then a copy: one register of any width up to 512 bits.
  float corner_half[16], corner_centre[16];
  // Edges by omitted axis times 8 plus sign bits, then 8 of padding: two registers of 512 bits.
  float edge_half[32], edge_centre[32];
  Slabs slabs;
  float origin[3];
  float half_box[3], per_half_box[3];  ///< positive, and their inverses
  float length[13];                    ///< length of the direction in the part, per metre
  float per_length[13];                ///< inverse of length
  // Inverse distances of the slabs from the origin; downwards negative.
  float per_reach_up[13], per_reach_down[13];
  bool holds_origin;  ///< inside every slab by more than rounding

  /// Lengths of the directions of `own` in units of this: half_box[i] / own.half_box[j].
  struct Ratios {
    float of[3][3];
  };
  Ratios ratios_to(const OrdopTable& own) const {
    Ratios out{};
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) out.of[i][j] = half_box[i] * own.per_half_box[j];
    return out;
  }

 private:
  void fill_lookups();
  void fill_inverses();
};

// OrdopLanes and ordop_pair() test the paper's or-DOP (slabs along the 13 unscaled directions)
// against another, the directions of one as lanes. They serve callers that test pair by pair.
// Invariant: kernels of all targets equal ordop_pair() below bit for bit.

inline constexpr size_t kDirectionSlots = 16;  // 13 directions and padding

/// Directions of all k-DOPs as lanes; padding is the null vector.
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

/// or-DOP of a part for ordop_pair, slabs as lanes. Directions that a k-DOP of this k does not have
/// are infinitely wide and never separate.
struct alignas(64) OrdopLanes {
  OrdopLanes(const Slabs& fitted, int k);
  OrdopTable table;
  float centre[kDirectionSlots], half[kDirectionSlots];
};

/// One or-DOP ("own") against another ("other"), in units of own's scale.
struct OrdopHalf {
  float other_from_own[3][3];  ///< multiplied by other's scale over own's
  float offset[3];             ///< other's centre, in own's frame
  float margin;
};

/// Both halves of a test. `shift_m`: root of b minus root of a, then the margin for rounding.
struct OrdopHalves {
  OrdopHalves(const OrdopTable& a, const PartPose& pose_a, float scale_a, const OrdopTable& b,
              const PartPose& pose_b, float scale_b, const float (&shift_m)[4]);
  OrdopHalf from_a, from_b;
};

/// Scalar reference.
template <int K>
bool ordop_pair(const OrdopLanes& a, const PartPose& pose_a, float scale_a, const OrdopLanes& b,
                const PartPose& pose_b, float scale_b, const float (&shift_m)[4]);

}  // namespace throng
