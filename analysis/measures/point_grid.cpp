#include "analysis/measures/point_grid.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr double kMaxCells = 1 << 20;

int cell(double offset_m, double cell_m, int cells) {
  return static_cast<int>(std::clamp(std::floor(offset_m / cell_m), 0.0, cells - 1.0));
}

}  // namespace

PointGrid::PointGrid(const Rectangle& ground, double cell_m)
    : ground_(ground),
      cell_m_(std::max(cell_m, std::sqrt(ground.area_m2() / kMaxCells))),
      columns_(static_cast<int>(ground.size_m().x() / cell_m_) + 1),
      rows_(static_cast<int>(ground.size_m().y() / cell_m_) + 1) {}

int PointGrid::column_of(double x) const { return cell(x - ground_.min_m.x(), cell_m_, columns_); }

int PointGrid::row_of(double y) const { return cell(y - ground_.min_m.y(), cell_m_, rows_); }

void PointGrid::place(std::span<const Eigen::Vector2d> points, std::span<const uint8_t> there) {
  points_ = points;
  const auto cell_of = [&](size_t i) {
    return static_cast<size_t>(row_of(points[i].y())) * static_cast<size_t>(columns_) +
           static_cast<size_t>(column_of(points[i].x()));
  };
  starts_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1, 0);
  for (size_t i = 0; i < points.size(); ++i)
    if (there[i] != 0) ++starts_[cell_of(i) + 1];
  for (size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  indices_.resize(starts_.back());
  next_.assign(starts_.begin(), starts_.end() - 1);
  for (size_t i = 0; i < points.size(); ++i)
    if (there[i] != 0) indices_[next_[cell_of(i)]++] = static_cast<uint32_t>(i);
}

}  // namespace throng
