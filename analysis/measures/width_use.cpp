#include "analysis/measures/width_use.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/trajectories/walkable_area.h"
#include "base/elementary.h"

namespace throng {
namespace {

constexpr double kCell_m = 0.05;
constexpr double kMaxCells = 4e6;

}  // namespace

WidthUse::WidthUse(const Scene& scene)
    : ground_(scene.ground),
      cell_m_(std::max(kCell_m, std::sqrt(ground_.area_m2() / kMaxCells))),
      columns_(static_cast<int>(ground_.size_m().x() / cell_m_) + 1),
      rows_(static_cast<int>(ground_.size_m().y() / cell_m_) + 1),
      visits_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 0) {
  for (const WalkablePolygon& polygon : walkable_area(scene))
    outline_.insert(outline_.end(), polygon.outline.begin(), polygon.outline.end());
}

void WidthUse::take(const Moment& moment, const Velocities& velocities) {
  for (size_t i = 0; i < moment.present.size(); ++i) {
    if (moment.present[i] == 0 || velocities.known[i] == 0) continue;
    const Eigen::Vector2d& v = velocities.of_mps[i];
    spread_ += v * v.transpose();
    sum_ += v;
    const Eigen::Vector2d offset = (moment.heads_m[i] - ground_.min_m) / cell_m_;
    const double column = std::clamp(std::floor(offset.x()), 0.0, columns_ - 1.0);
    const double row = std::clamp(std::floor(offset.y()), 0.0, rows_ - 1.0);
    ++visits_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
              static_cast<size_t>(column)];
  }
}

Eigen::Vector2d WidthUse::main_direction() const {
  const SinCos along = sin_cos(0.5 * arc_tan2(2 * spread_(0, 1), spread_(0, 0) - spread_(1, 1)));
  const Eigen::Vector2d axis(along.cos, along.sin);
  return axis.dot(sum_) < 0 ? Eigen::Vector2d(-axis) : axis;
}

MeasureTable WidthUse::table() const {
  const Eigen::Vector2d ahead = main_direction();
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  MeasureTable table{"width_use",
                     "Use of the width",
                     "width",
                     "m from the right edge",
                     "Share of the time of all people in lanes of 0.5 m across the direction in "
                     "which most walk, from the right edge of the walkable area.",
                     {},
                     {}};
  if (outline_.empty()) return table;
  double right = left.dot(outline_.front());
  for (const Eigen::Vector2d& corner : outline_) right = std::min(right, left.dot(corner));
  std::map<int, uint64_t> lanes;
  uint64_t all = 0;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const uint32_t visits = visits_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                                      static_cast<size_t>(column)];
      if (visits == 0) continue;
      const Eigen::Vector2d place =
          ground_.min_m + cell_m_ * Eigen::Vector2d(column + 0.5, row + 0.5);
      lanes[static_cast<int>(std::floor((left.dot(place) - right) / kLane_m))] += visits;
      all += visits;
    }
  if (all == 0) return table;
  for (int lane = lanes.begin()->first; lane <= lanes.rbegin()->first; ++lane) {
    const auto found = lanes.find(lane);
    const double share =
        found == lanes.end() ? 0 : static_cast<double>(found->second) / static_cast<double>(all);
    table.rows.push_back(
        ranged_row(lane * kLane_m, (lane + 1) * kLane_m, "", "share", "%", 100 * share));
  }
  return table;
}

}  // namespace throng
