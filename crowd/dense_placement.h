// Bodies that stand close together: where each finds room, as ellipses seen from above.
// One rule: bodies, not discs, keep clear of each other; the same seed gives the same places, and
// no pattern of a grid.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/rectangle.h"
#include "crowd/navigation/walkable.h"

namespace throng {

/// Somebody who stands, seen from above.
struct StandingBody {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();  ///< unit: the way of the short axis
  double size = 1;                                     ///< height / 1.70 m

  // Of a person of 1.70 m: half the shoulders, and half the chest with the arms beside it.
  static constexpr double kHalfWidth_m = 0.26;
  static constexpr double kHalfDepth_m = 0.15;

  /// From the middle to the rim, towards a unit vector.
  double radius_m(const Eigen::Vector2d& towards) const;
};

/// How far two bodies reach into each other, along the line of their middles: exact for bodies that
/// face the same way. Negative where they are apart.
double overlap_m(const StandingBody& a, const StandingBody& b);

/// Of any two of them; minus infinity of fewer than two.
double max_overlap_m(std::span<const StandingBody> bodies);

/// Somebody else who stands there already.
struct StandingDisc {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  double radius_m = 0;
};

/// Where bodies are to stand.
struct StandingArea {
  const Walkable& walkable;
  Rectangle area;
  double wall_gap_m = 0;  ///< middles keep so far off obstacles
  std::span<const StandingDisc> others = {};
  /// The way that a body faces at a place.
  std::function<Eigen::Vector2d(size_t body, const Eigen::Vector2d& place_m)> facing;
};

/// Gives each of the bodies, whose sizes are known, a place and a heading: spread evenly over the
/// ground, shaken, then pushed apart until bodies and, where there is room, some room around them
/// are clear. Returns 1 for each body that found room, 0 for one that did not.
std::vector<uint8_t> place_standing(const StandingArea& where, uint64_t seed,
                                    std::span<StandingBody> bodies);

}  // namespace throng
