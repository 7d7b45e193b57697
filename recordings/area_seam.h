// AreaEdge is an edge of a walkable area; Seam is where two of them face each other across a gap.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "recordings/area_grid.h"
#include "recordings/walkable_wkt.h"

namespace throng {

/// Edges that face each other from no farther away belong together.
inline constexpr double kMaxAreaGap_m = 1e-3;
/// Files print places to 0.1 mm: a gap of 1 mm may be so much wider.
inline constexpr double kAreaRounding_m = 0.9e-4;
/// Corners lie on the grid within 0.07 mm; two edges of one line differ by twice that.
inline constexpr double kOffGrid_m = 1.5 * kAreaUnit_m;

/// From one corner of a ring to the next; the walkable side is on the left.
struct AreaEdge {
  Eigen::Vector2d from, to;
  uint32_t polygon = 0;
  bool may_slit = false;  ///< of a ring that is wider than a gap

  double distance_m(const Eigen::Vector2d& p) const;
  double distance_m(const AreaEdge& other) const;
};

/// Where two edges face each other across a gap, or along a line that they share.
struct Seam {
  AreaPolygon::Ring filling;  ///< from one polygon to the other
  double width_m = 0, length_m = 0;
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
};

std::optional<Seam> seam_between(const AreaEdge& a, const AreaEdge& b);

}  // namespace throng
