#include "scenes/flow_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace throng {
namespace {

/// Two cells fit between the margins of a doorway of 0.8 m; finer ones only cost memory.
constexpr double kFinestCell_m = 0.2;
/// A field of a million cells takes 12 MB and half a second to march.
constexpr double kMaxCells = 1 << 20;
/// A centre passes this near to a wall, in a doorway.
constexpr double kBodyMargin_m = 0.2;
/// People would rather keep so far from walls: half the shoulders and a hand's breadth.
constexpr double kComfort_m = 0.5;
/// What a metre at a wall counts, in the open.
constexpr double kSlowest = 2.5;
constexpr float kFar = std::numeric_limits<float>::infinity();

/// Neighbours in the order left, right, below, above; -1 where the grid ends.
struct Neighbours {
  ptrdiff_t cell[4];
};

Neighbours neighbours_of(const FlowGrid& grid, size_t cell) {
  const auto columns = static_cast<ptrdiff_t>(grid.columns());
  const auto at = static_cast<ptrdiff_t>(cell);
  const ptrdiff_t column = at % columns;
  const ptrdiff_t row = at / columns;
  return {{column > 0 ? at - 1 : -1, column + 1 < columns ? at + 1 : -1,
           row > 0 ? at - columns : -1, row + 1 < grid.rows() ? at + columns : -1}};
}

/// Distance from the nearer neighbour along each axis: the upwind scheme's quadratic.
double eikonal(double x, double y, double step_m) {
  const double low = std::min(x, y);
  const double high = std::max(x, y);
  if (high - low >= step_m) return low + step_m;
  const double gap = high - low;
  return 0.5 * (low + high + std::sqrt(2 * step_m * step_m - gap * gap));
}

}  // namespace

FlowGrid::FlowGrid(const Walkable& walkable) : origin_m_(walkable.ground().min_m) {
  const Eigen::Vector2d size = walkable.ground().size_m();
  cell_m_ = std::max(kFinestCell_m, std::sqrt(size.prod() / kMaxCells));
  columns_ = std::max(1, static_cast<int>(std::ceil(size.x() / cell_m_)));
  rows_ = std::max(1, static_cast<int>(std::ceil(size.y() / cell_m_)));
  const double margin = margin_m(cell_m_);
  slowness_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  for (size_t cell = 0; cell < slowness_.size(); ++cell) {
    const Eigen::Vector2d centre = centre_m(cell);
    double clearance = Walkable::kReach_m;
    for (const uint32_t footprint : walkable.near(centre))
      clearance = std::min(clearance, walkable.nearest(footprint, centre).distance_m);
    const double tightness = std::clamp((kComfort_m - clearance) / kComfort_m, 0.0, 1.0);
    if (clearance >= margin && walkable.ground().contains(centre))
      slowness_[cell] = static_cast<float>(1 + (kSlowest - 1) * tightness);
  }
}

double FlowGrid::margin_m(double cell_m) { return std::max(kBodyMargin_m, 0.71 * cell_m); }

Eigen::Vector2d FlowGrid::centre_m(size_t cell) const {
  const auto columns = static_cast<size_t>(columns_);
  return origin_m_ + cell_m_ * Eigen::Vector2d(static_cast<double>(cell % columns) + 0.5,
                                               static_cast<double>(cell / columns) + 0.5);
}

size_t FlowGrid::cell_at(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d offset = (point - origin_m_) / cell_m_;
  const int column = std::clamp(static_cast<int>(std::floor(offset.x())), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(std::floor(offset.y())), 0, rows_ - 1);
  return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
}

FlowField::FlowField(const FlowGrid& grid, std::span<const Rectangle> areas)
    : grid_(&grid),
      distance_m_(grid.cell_count(), kFar),
      direction_(grid.cell_count(), Eigen::Vector2f::Zero()) {
  march(areas);
  point_downhill();
  lead_out_of_walls();
}

void FlowField::march(std::span<const Rectangle> areas) {
  // A queue of (distance, cell): equal distances leave in the order of cells.
  using Entry = std::pair<float, size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (size_t cell = 0; cell < distance_m_.size(); ++cell) {
    if (!grid_->is_free(cell)) continue;
    // The cell's distance to a rectangle, so that small goals between cell centres count too.
    const Eigen::Vector2d centre = grid_->centre_m(cell);
    double away = 1e300;
    for (const Rectangle& area : areas)
      away = std::min(away, (centre - centre.cwiseMax(area.min_m).cwiseMin(area.max_m)).norm());
    if (away > 0.71 * grid_->cell_m()) continue;
    distance_m_[cell] = static_cast<float>(away);
    queue.emplace(distance_m_[cell], cell);
  }
  const auto value = [&](ptrdiff_t cell) {
    return cell < 0 ? kFar : distance_m_[static_cast<size_t>(cell)];
  };
  while (!queue.empty()) {
    const auto [distance, cell] = queue.top();
    queue.pop();
    if (distance > distance_m_[cell]) continue;
    for (const ptrdiff_t next : neighbours_of(*grid_, cell).cell) {
      if (next < 0 || !grid_->is_free(static_cast<size_t>(next))) continue;
      const Neighbours around = neighbours_of(*grid_, static_cast<size_t>(next));
      const auto x = static_cast<double>(std::min(value(around.cell[0]), value(around.cell[1])));
      const auto y = static_cast<double>(std::min(value(around.cell[2]), value(around.cell[3])));
      const double step_m = grid_->cell_m() * grid_->slowness(static_cast<size_t>(next));
      const auto found = static_cast<float>(eikonal(x, y, step_m));
      if (!(found < distance_m_[static_cast<size_t>(next)])) continue;
      distance_m_[static_cast<size_t>(next)] = found;
      queue.emplace(found, static_cast<size_t>(next));
    }
  }
}

void FlowField::point_downhill() {
  const auto fall = [&](float here, ptrdiff_t back, ptrdiff_t ahead) {
    const float behind = back < 0 ? kFar : distance_m_[static_cast<size_t>(back)];
    const float before = ahead < 0 ? kFar : distance_m_[static_cast<size_t>(ahead)];
    const float lower = std::min(behind, before);
    if (!(lower < here)) return 0.0f;
    return before < behind ? here - lower : lower - here;
  };
  for (size_t cell = 0; cell < distance_m_.size(); ++cell) {
    if (!(distance_m_[cell] < kFar)) continue;
    const Neighbours around = neighbours_of(*grid_, cell);
    const Eigen::Vector2f down(fall(distance_m_[cell], around.cell[0], around.cell[1]),
                               fall(distance_m_[cell], around.cell[2], around.cell[3]));
    if (down.squaredNorm() > 0) direction_[cell] = down.normalized();
  }
}

void FlowField::lead_out_of_walls() {
  // Whoever was pushed too near an obstacle goes to the nearest cell with a way: breadth first.
  std::vector<size_t> front;
  std::vector<uint8_t> known(distance_m_.size());
  for (size_t cell = 0; cell < distance_m_.size(); ++cell) {
    known[cell] = distance_m_[cell] < kFar;
    if (known[cell]) front.push_back(cell);
  }
  for (size_t i = 0; i < front.size(); ++i) {
    for (const ptrdiff_t next : neighbours_of(*grid_, front[i]).cell) {
      if (next < 0) continue;
      const auto cell = static_cast<size_t>(next);
      if (known[cell] || grid_->is_free(cell)) continue;
      known[cell] = 1;
      const Eigen::Vector2d out = grid_->centre_m(front[i]) - grid_->centre_m(cell);
      // Mostly along the way of the cell outside: straight out would be turned back at once.
      const Eigen::Vector2f way = direction_[front[i]] + 0.5f * out.normalized().cast<float>();
      direction_[cell] = way.normalized();
      front.push_back(cell);
    }
  }
}

FlowField::Patch FlowField::patch_at(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d offset = (point - grid_->origin_m()) / grid_->cell_m();
  const double x = std::clamp(offset.x() - 0.5, 0.0, static_cast<double>(grid_->columns() - 1));
  const double y = std::clamp(offset.y() - 0.5, 0.0, static_cast<double>(grid_->rows() - 1));
  const auto column = static_cast<size_t>(x);
  const auto row = static_cast<size_t>(y);
  const auto columns = static_cast<size_t>(grid_->columns());
  return {row * columns + column, column + 1 < columns ? size_t{1} : 0,
          row + 1 < static_cast<size_t>(grid_->rows()) ? columns : 0,
          x - static_cast<double>(column), y - static_cast<double>(row)};
}

void FlowField::prefetch(const Eigen::Vector2d& point) const {
  const Patch patch = patch_at(point);
  __builtin_prefetch(&direction_[patch.cell]);
  __builtin_prefetch(&direction_[patch.cell + patch.above]);
}

Eigen::Vector2d FlowField::direction(const Eigen::Vector2d& point) const {
  const auto [cell, right, above, fx, fy] = patch_at(point);
  const auto at = [&](size_t index) -> Eigen::Vector2d { return direction_[index].cast<double>(); };
  const Eigen::Vector2d blend = (1 - fy) * ((1 - fx) * at(cell) + fx * at(cell + right)) +
                                fy * ((1 - fx) * at(cell + above) + fx * at(cell + above + right));
  // Where ways part, directions cancel: take the cell's own then.
  const Eigen::Vector2d chosen = blend.squaredNorm() > 0.01 ? blend : at(grid_->cell_at(point));
  const double length = chosen.norm();
  return length > 0 ? Eigen::Vector2d(chosen / length) : Eigen::Vector2d::Zero();
}

double FlowField::distance_m(const Eigen::Vector2d& point) const {
  return static_cast<double>(distance_m_[grid_->cell_at(point)]);
}

bool FlowField::reaches(const Eigen::Vector2d& point) const {
  return distance_m_[grid_->cell_at(point)] < kFar;
}

}  // namespace throng
