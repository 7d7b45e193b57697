// How near parts are to each other: every pair within a margin, with an interval that holds its
// distance; of each two bodies the pair that is nearest; and where those that touch do.
// One rule: no pair within the margin is missed; an interval is proven from both sides.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "culling/pair.h"

namespace throng {

/// Larger margins are refused: a mistake of units, more likely than not.
inline constexpr float kMostNear_m = 100;

struct NearOptions {
  /// Every pair of parts of two bodies that is not proven farther apart is listed; 0: none.
  float near_m = 0;
  /// Of each two bodies, neither of them static, that are not proven farther apart the nearest pair
  /// of parts; 0: none.
  float body_near_m = 0;
  /// From frame to frame, for closing speeds; 0: they are unknown.
  double step_s = 0;
  /// Of every pair of parts that touches a point; needs triangles, and no margin.
  bool contact_points = false;

  /// Margins.
  bool is_asked() const { return near_m > 0 || body_near_m > 0; }
  bool needs_search() const { return is_asked() || contact_points; }
  float most_m() const { return near_m > body_near_m ? near_m : body_near_m; }
};

/// The distance of two parts' triangles, of points where there are none; 0 where they touch or one
/// solid holds the other. What stands below `level` is known where the triangles were asked
/// (PairLevel::kExact), else it is NaN.
struct NearPair {
  PairKey pair;
  float lo_m = 0, hi_m = 0;  ///< hold the distance; at most 1 mm apart by triangles
  PairLevel level = PairLevel::kPartVolume;

  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  static constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  /// Of part a and of part b, in the world: nearest to each other at hi_m; where they touch, twice
  /// a point that both share.
  std::array<double, 3> point_a_m = {kNowhere, kNowhere, kNowhere};
  std::array<double, 3> point_b_m = {kNowhere, kNowhere, kNowhere};
  /// Unit, from a to b: along the points; where they touch, along which b is out of a soonest.
  std::array<float, 3> normal = {kUnknown, kUnknown, kUnknown};
  float depth_m = 0;  ///< of the convex hulls, along the normal; 0: apart (see hull_depth.h)
  /// At which the material of the parts at the two points came nearer along the normal since the
  /// last frame; NaN also where a body was not near anybody, or not there, in the last frame.
  float closing_mps = kUnknown;

  /// At that speed; 0 where they touch, infinite where they do not come nearer, NaN where it is
  /// unknown.
  float contact_in_s() const {
    if (level == PairLevel::kExact && hi_m == 0) return 0;
    if (!(closing_mps <= 0)) return hi_m / closing_mps;
    return std::numeric_limits<float>::infinity();
  }
};

/// Where two parts touch and how deep, as a NearPair of theirs has it.
struct ContactPoint {
  PairKey pair;
  std::array<double, 3> point_m = {};   ///< that both share, in the world
  std::array<float, 3> direction = {};  ///< unit: along which b is out of a soonest
  float depth_m = 0;                    ///< of the convex hulls, along it
};

}  // namespace throng
