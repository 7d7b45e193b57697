// The room that somebody has: a Voronoi cell, cut at the walls.
// One rule: of a cell that a wall cuts apart only the part with the person counts.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "crowd/navigation/walkable.h"
#include "scenes/file/scene.h"

namespace throng {

struct VoronoiCell {
  double area_m2 = 0;
  bool is_capped = false;  ///< reaches kCap_m in some direction in which no wall ends it before
};

class VoronoiCells {
 public:
  /// Nobody's cell reaches farther than this: at the rim of a crowd the rest belongs to no one.
  static constexpr double kCap_m = 2;

  explicit VoronoiCells(const Scene& scene);

  /// The cell of a person at `point`; `others` hold everybody else nearer than 2 kCap_m, in any
  /// order. Those at the very same point share it. Nothing for a point in an obstacle or off the
  /// ground.
  std::optional<VoronoiCell> cell(const Eigen::Vector2d& point,
                                  std::span<const Eigen::Vector2d> others);

 private:
  void cut(const Eigen::Vector2d& normal, double offset);
  std::optional<VoronoiCell> without_obstacles(const Eigen::Vector2d& point);

  Walkable walkable_;
  std::vector<std::vector<Eigen::Vector2d>> footprints_;
  // Of the latest cell, as offsets from its person; kept for their memory.
  std::vector<Eigen::Vector2d> corners_;
  std::vector<Eigen::Vector2d> cut_;
  std::vector<std::pair<double, Eigen::Vector2d>> sorted_neighbours_;
};

}  // namespace throng
