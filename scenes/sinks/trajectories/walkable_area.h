// The area that people can walk on as polygons: the ground less the footprints of obstacles.
// One rule: the polygons are valid as OGC defines it, so that geometry libraries take them.
#pragma once

#include <Eigen/Core>
#include <string>
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

/// POLYGON, or MULTIPOLYGON if there are several; metres.
std::string walkable_wkt(const Scene& scene);

}  // namespace throng
