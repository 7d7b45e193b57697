// LocalDensity computes the density of people around a point; PointGrid finds points near a point.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "crowd/navigation/walkable.h"
#include "scenes/file/scene.h"

namespace throng {

/// Points sorted into square cells.
/// Invariant: the visiting order depends on the points alone.
class PointGrid {
 public:
  /// `cell_m`: approximate cell size; larger on grounds that would have too many cells.
  PointGrid(const Rectangle& ground, double cell_m);

  /// Inserts the points with there[i] != 0; empty: all. The points must outlive the visits. Points
  /// off the ground are found as well.
  void place(std::span<const Eigen::Vector2d> points, std::span<const uint8_t> there);

  /// Calls visit(index, squared distance) for all points within the radius, including its centre.
  template <typename Visit>
  void for_each_within(const Eigen::Vector2d& point, double radius_m, const Visit& visit) const {
    const int first = column_of(point.x() - radius_m), last = column_of(point.x() + radius_m);
    for (int row = row_of(point.y() - radius_m); row <= row_of(point.y() + radius_m); ++row) {
      const auto line = static_cast<size_t>(row) * static_cast<size_t>(columns_);
      const uint32_t end = starts_[line + static_cast<size_t>(last) + 1];
      for (uint32_t i = starts_[line + static_cast<size_t>(first)]; i < end; ++i) {
        const double squared = (points_[indices_[i]] - point).squaredNorm();
        if (squared <= radius_m * radius_m) visit(indices_[i], squared);
      }
    }
  }
  const Eigen::Vector2d& point(uint32_t index) const { return points_[index]; }

 private:
  int column_of(double x) const;
  int row_of(double y) const;

  Rectangle ground_;
  double cell_m_;
  int columns_;
  int rows_;
  std::span<const Eigen::Vector2d> points_;
  std::vector<uint32_t> starts_;  ///< start in indices_ by cell; see counting_sort()
  std::vector<uint32_t> indices_;
};

/// Density around a point: number of people in a circle over the part of the circle that is visible
/// from its centre. Walls and the area behind them do not count as free area: a person at a wall
/// or in a narrow corridor would otherwise appear half as crowded.
class LocalDensity {
 public:
  /// One person in this circle of 12.6 m2 adds 0.08 per m2.
  static constexpr double kRadius_m = 2;

  explicit LocalDensity(const Scene& scene);

  /// Sets the people of a frame: those with present[id] != 0; empty: all. The spans must outlive
  /// the calls of around().
  void place(std::span<const Eigen::Vector2d> positions_m, std::span<const uint8_t> present) {
    grid_.place(positions_m, present);
  }
  /// People per m2 within kRadius_m of the point, including a person at the point and excluding
  /// people behind walls.
  double around(const Eigen::Vector2d& point) const;

 private:
  Eigen::Vector2d push_off_walls(Eigen::Vector2d point) const;
  int people_within(const Eigen::Vector2d& point, bool is_unobstructed) const;

  Walkable walkable_;
  Rectangle ground_;
  PointGrid grid_;
};

/// Density levels after Fruin (1971) and Helbing et al.; level i + 1 begins at bounds[i] people per
/// m2.
struct DensityLevels {
  static constexpr std::array<double, 5> kBounds = {0.43, 2.0, 3.57, 5.55, 7.1};
  static constexpr std::array<const char*, 6> kNames = {"free walking",     "among others",
                                                        "reduced speed",    "involuntary contact",
                                                        "dangerous forces", "critical"};
  static constexpr size_t kCount = kNames.size();
  static size_t level_of(double density_per_m2);
};

}  // namespace throng
