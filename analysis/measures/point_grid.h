// Who is near a point: people sorted into square cells.
// One rule: a visit depends on the points alone; it goes through them in one order.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "scenes/file/scene.h"

namespace throng {

class PointGrid {
 public:
  /// Cells of about this size, larger where there would be too many.
  PointGrid(const Rectangle& ground, double cell_m);

  /// Those with there[i] != 0. The points must outlive the visits. Points off the ground are found,
  /// too.
  void place(std::span<const Eigen::Vector2d> points, std::span<const uint8_t> there);

  /// Calls visit(index, squared distance) for all within the radius, one at the point included.
  template <typename Visit>
  void each_near(const Eigen::Vector2d& point, double radius_m, const Visit& visit) const {
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

 private:
  int column_of(double x) const;
  int row_of(double y) const;

  Rectangle ground_;
  double cell_m_;
  int columns_;
  int rows_;
  std::span<const Eigen::Vector2d> points_;
  std::vector<uint32_t> starts_;  ///< cells + 1 entries into indices_
  std::vector<uint32_t> indices_;
  std::vector<uint32_t> next_;
};

}  // namespace throng
