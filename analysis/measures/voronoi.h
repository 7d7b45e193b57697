// VoronoiCells computes the free area of a person: a Voronoi cell, cut at walls.
// Invariant: if a wall divides a cell, only the piece with the person counts.
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
  bool is_capped = false;  ///< true if the cell reaches kCap_m in a direction without a wall
};

class VoronoiCells {
 public:
  /// Maximum radius of a cell; bounds cells at the rim of a crowd.
  static constexpr double kCap_m = 2;

  explicit VoronoiCells(const Scene& scene);

  /// Cell of a person at `point`. `others`: all other people within 2 kCap_m, in any order. People
  /// at the same point share its cell. None for points in an obstacle or off the ground.
  std::optional<VoronoiCell> cell(const Eigen::Vector2d& point,
                                  std::span<const Eigen::Vector2d> others);

 private:
  void cut(const Eigen::Vector2d& normal, double offset);
  std::optional<VoronoiCell> without_obstacles(const Eigen::Vector2d& point);

  Walkable walkable_;
  std::vector<std::vector<Eigen::Vector2d>> footprints_;
  // Polygons of the latest cell relative to its person; members to reuse their memory.
  std::vector<Eigen::Vector2d> corners_;
  std::vector<Eigen::Vector2d> cut_;
  std::vector<std::pair<double, Eigen::Vector2d>> sorted_neighbours_;
};

}  // namespace throng
