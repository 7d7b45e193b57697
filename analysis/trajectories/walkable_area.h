// The area that people can walk on as polygons: the ground less the footprints of obstacles.
// One rule: the polygons are valid as OGC defines it, so that geometry libraries take them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/file/scene.h"

namespace throng {

/// Closed rings: the first corner is not repeated.
struct WalkablePolygon {
  std::vector<Eigen::Vector2d> outline;             ///< counter-clockwise
  std::vector<std::vector<Eigen::Vector2d>> holes;  ///< clockwise
};

/// To a tenth of a millimetre; obstacles are taken that much larger, so that those that touch in a
/// corner join. Several polygons where obstacles cut the ground apart, largest first; none if they
/// cover it.
std::vector<WalkablePolygon> walkable_area(const Scene& scene);

/// The one polygon that a trajectory's file has for the walkable area.
struct TrajectoryArea {
  std::string wkt;  ///< POLYGON, metres
  size_t piece = 1, pieces = 1;
};

/// `piece`: which of several pieces, 1 is the largest; none: there is only one. Pieces in
/// which no disc of the smallest radius has room do not count. Throws InputError if there is no
/// walkable area or no such piece, or several and none is chosen; `option` is the one that chooses.
TrajectoryArea trajectory_area(const Scene& scene, std::optional<int64_t> piece,
                               std::string_view option = "--trajectory-area");

/// What the option that chooses takes: a whole number from 1, or "largest", which is 1. None for
/// other words.
std::optional<int64_t> trajectory_piece(std::string_view word);

}  // namespace throng
