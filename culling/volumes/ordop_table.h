// An or-DOP laid out for the kernels that test it.
// One rule: made once from the points of a part; kernels only read it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "base/pose.h"
#include "culling/volumes/slabs.h"

namespace throng {

/// A part's or-DOP laid out for lookup by the sign bits of a direction (bit 0: x negative, ...).
/// Its slabs are those of the points (p - origin) / half_box, around the centre of the part's box
/// and in units of its half sides: the edge and corner planes then cut a long box where they cut a
/// cube, which leaves a quarter of the false positives of unscaled directions away. The three axis
/// slabs have centre zero and drop out of every sum.
struct alignas(64) OrdopTable {
  /// At least one point.
  explicit OrdopTable(std::span<const Eigen::Vector3f> points);
  /// The paper's or-DOP: slabs as fitted, recentred but in metres (half_box 1).
  explicit OrdopTable(const Slabs& fitted);
  // Eight corners by sign bits, then a copy: one register of any width up to 512 bits.
  float corner_half[16], corner_centre[16];
  // Edges by the axis that the direction leaves out, times 8, plus sign bits; the last 8 are
  // padding: two registers of 512 bits.
  float edge_half[32], edge_centre[32];
  Slabs slabs;
  float origin[3];
  float half_box[3], per_half_box[3];  ///< positive; and their inverses
  float length[13];                    ///< of the direction as it stands in the part, per metre
  float per_length[13];                ///< its inverse
  // How far the slabs reach from the origin, inverted, downwards with a minus sign.
  float per_reach_up[13], per_reach_down[13];
  bool holds_origin;  ///< inside every slab, and not by rounding alone

  /// How far directions of `own` reach in units of this: half_box[i] / own.half_box[j].
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

// The paper's or-DOP (slabs along the 13 directions as they are), one against one other, the
// directions of one as lanes: for who tests pair by pair and cannot collect pairs of the same
// parts. One rule: the answer is that of ordop_pair() below to the bit, on every target.

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
