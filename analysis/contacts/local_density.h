// Who is near a point, and how dense it is there.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "crowd/navigation/walkable.h"
#include "scenes/file/scene.h"

namespace throng {

/// Who is near a point: people sorted into square cells.
/// A visit depends on the points alone; it goes through them in one order.
class PointGrid {
 public:
  /// Cells of about this size, larger where there would be too many.
  PointGrid(const Rectangle& ground, double cell_m);

  /// Those with there[i] != 0; empty: all. The points must outlive the visits. Points off the
  /// ground are found, too.
  void place(std::span<const Eigen::Vector2d> points, std::span<const uint8_t> there);

  /// Calls visit(index, squared distance) for all within the radius, one at the point included.
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
  std::vector<uint32_t> starts_;  ///< by cell, of indices_; see counting_sort()
  std::vector<uint32_t> indices_;
};

/// How dense it is around somebody: people in a circle over the part of it that is seen from its
/// middle.
/// A wall takes room away, and so does what is behind it, so that neither a person beside
/// one nor a file in a narrow corridor counts as half alone.
class LocalDensity {
 public:
  /// The circle holds 12.6 m2, so that one person more or less is 0.08 per m2.
  static constexpr double kRadius_m = 2;

  explicit LocalDensity(const Scene& scene);

  /// Takes a frame's people, those with present[id] != 0; empty: all. The spans must outlive the
  /// calls of around().
  void place(std::span<const Eigen::Vector2d> positions_m, std::span<const uint8_t> present) {
    grid_.place(positions_m, present);
  }
  /// People per m2 within kRadius_m of the point, somebody there included, and nobody behind a
  /// wall.
  double around(const Eigen::Vector2d& point) const;

 private:
  Eigen::Vector2d push_off_walls(Eigen::Vector2d point) const;
  int people_within(const Eigen::Vector2d& point, bool is_unobstructed) const;

  Walkable walkable_;
  Rectangle ground_;
  PointGrid grid_;
};

/// Levels of density after Fruin (1971) and Helbing et al.: above bounds[i] people per m2 begins
/// level i + 1.
struct DensityLevels {
  static constexpr std::array<double, 5> kBounds = {0.43, 2.0, 3.57, 5.55, 7.1};
  static constexpr std::array<const char*, 6> kNames = {"free walking",     "among others",
                                                        "reduced speed",    "involuntary contact",
                                                        "dangerous forces", "critical"};
  static constexpr size_t kCount = kNames.size();
  static size_t level_of(double density_per_m2);
};

}  // namespace throng
