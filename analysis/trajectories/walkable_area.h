// walkable_area computes the ground minus the footprints of obstacles, as polygons.
// Invariant: the polygons are valid as defined by OGC, as geometry libraries require.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/file/scene.h"

namespace throng {

/// Walkable polygons, accurate to 0.1 mm, largest first; empty if obstacles cover the ground.
/// Outlines are counter-clockwise, holes clockwise.
/// Obstacles grow by 0.1 mm, which joins those that touch at a corner.
std::vector<Polygon> walkable_area(const Scene& scene);

/// The polygon that a trajectory file stores as the walkable area.
struct TrajectoryArea {
  std::string wkt;  ///< POLYGON, metres
  size_t piece = 1, pieces = 1;
};

/// Chooses a polygon. `piece`: its rank by size from 1; none: the area must have one piece. Pieces
/// too small for the smallest disc do not count. Throws InputError if there is no walkable area, no
/// such piece, or several pieces without a choice; `option` names the option that chooses.
TrajectoryArea trajectory_area(const Scene& scene, std::optional<int64_t> piece,
                               std::string_view option = "--trajectory-area");

/// Parses a choice of piece: an integer from 1, or "largest" (1). None for other words.
std::optional<int64_t> trajectory_piece(std::string_view word);

}  // namespace throng
