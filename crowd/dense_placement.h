// Dense placement puts standing bodies close together, as ellipses seen from above.
// Invariant: bodies, not discs, are disjoint; equal seeds give equal places, without a visible
// grid.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "crowd/navigation/walkable.h"
#include "geometry/area.h"

namespace throng {

/// A standing body seen from above.
struct StandingBody {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();  ///< unit vector along the short axis
  double size = 1;                                     ///< height / 1.70 m

  // Half axes for a height of 1.70 m: half the shoulders, half the chest with the arms.
  static constexpr double kHalfWidth_m = 0.26;
  static constexpr double kHalfDepth_m = 0.15;

  /// Returns the distance from the middle to the rim along a unit vector.
  double radius_m(const Eigen::Vector2d& towards) const;
};

/// Returns the overlap of two bodies along the line of their middles (m); negative if apart. Exact
/// for bodies that face the same direction.
double overlap_m(const StandingBody& a, const StandingBody& b);

/// Returns the largest overlap of any two bodies; minus infinity for fewer than two.
double max_overlap_m(std::span<const StandingBody> bodies);

/// An agent that is already there.
struct StandingDisc {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  double radius_m = 0;
};

struct StandingArea {
  const Walkable& walkable;
  Area area;
  double wall_gap_m = 0;  ///< minimum distance of middles to obstacles
  std::span<const StandingDisc> others = {};
  /// Returns the unit vector that a body at a place faces.
  std::function<Eigen::Vector2d(size_t body, const Eigen::Vector2d& place_m)> facing;
};

/// Sets place and heading of each body; the sizes are given. Places are spread evenly over the
/// ground, randomised, then pushed apart until bodies are clear, with extra room if there is any.
/// Returns 1 for each placed body, 0 for one without room.
std::vector<uint8_t> place_standing(const StandingArea& where, uint64_t seed,
                                    std::span<StandingBody> bodies);

}  // namespace throng
