#include "scenes/neighbour_grid.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

/// At one person per m2 nine cells hold twenty people, twice the ten that steering looks at.
constexpr double kCell_m = 1.5;
constexpr double kMaxCells = 1 << 20;

bool before(const Neighbour& a, const Neighbour& b) {
  return a.square_m2 < b.square_m2 || (a.square_m2 == b.square_m2 && a.id < b.id);
}

}  // namespace

NeighbourGrid::NeighbourGrid(const Rectangle& ground) : origin_m_(ground.min_m) {
  const Eigen::Vector2d size = ground.size_m();
  cell_m_ = std::max(kCell_m, std::sqrt(size.prod() / kMaxCells));
  columns_ = std::max(1, static_cast<int>(std::ceil(size.x() / cell_m_)));
  rows_ = std::max(1, static_cast<int>(std::ceil(size.y() / cell_m_)));
  starts_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1);
}

size_t NeighbourGrid::cell_of(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d offset = (point - origin_m_) / cell_m_;
  const int column = std::clamp(static_cast<int>(std::floor(offset.x())), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(std::floor(offset.y())), 0, rows_ - 1);
  return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
}

void NeighbourGrid::rebuild(std::span<const Eigen::Vector2d> positions_m,
                            std::span<const uint8_t> present) {
  const size_t count = positions_m.size();
  const auto is_in = [&](size_t id) { return present.empty() || present[id] != 0; };
  cells_.resize(count);
  positions_m_.assign(positions_m.begin(), positions_m.end());
  std::fill(starts_.begin(), starts_.end(), 0);
  size_t in = 0;
  for (size_t id = 0; id < count; ++id) {
    if (!is_in(id)) continue;
    cells_[id] = static_cast<uint32_t>(cell_of(positions_m[id]));
    ++starts_[cells_[id] + 1];
    ++in;
  }
  // Room for everybody from the start: who enters later must not make a step allocate.
  order_.reserve(count);
  sorted_m_.reserve(count);
  order_.resize(in);
  sorted_m_.resize(in);
  for (size_t cell = 1; cell < starts_.size(); ++cell) starts_[cell] += starts_[cell - 1];
  // Filling moves each start to its cell's end, which is the next cell's start: shift back after.
  for (size_t id = 0; id < count; ++id) {
    if (!is_in(id)) continue;
    const uint32_t slot = starts_[cells_[id]]++;
    order_[slot] = static_cast<uint32_t>(id);
    sorted_m_[slot] = positions_m[id];
  }
  std::move_backward(starts_.begin(), starts_.end() - 1, starts_.end());
  starts_.front() = 0;
}

void NeighbourGrid::visit_cell(int column, int row, uint32_t id, double reach_square,
                               std::span<Neighbour> out, size_t& count) const {
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return;
  const size_t cell =
      static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
  for (uint32_t slot = starts_[cell]; slot < starts_[cell + 1]; ++slot) {
    const Neighbour found{(sorted_m_[slot] - positions_m_[id]).squaredNorm(), order_[slot]};
    if (found.id == id || found.square_m2 > reach_square) continue;
    if (count == out.size()) {
      if (!before(found, out[count - 1])) continue;
      --count;
    }
    size_t place = count++;
    for (; place > 0 && before(found, out[place - 1]); --place) out[place] = out[place - 1];
    out[place] = found;
  }
}

size_t NeighbourGrid::nearest(uint32_t id, double reach_m, std::span<Neighbour> out) const {
  const int column = static_cast<int>(cells_[id]) % columns_;
  const int row = static_cast<int>(cells_[id]) / columns_;
  const Eigen::Vector2d inside =
      positions_m_[id] - origin_m_ - cell_m_ * Eigen::Vector2d(column, row);
  // How far the point is from the border of its own cell, at least.
  const double margin = std::max(
      0.0, std::min(inside.minCoeff(), (Eigen::Vector2d::Constant(cell_m_) - inside).minCoeff()));
  size_t count = 0;
  if (out.empty()) return count;
  const int rings = std::max(columns_, rows_);
  for (int ring = 0; ring <= rings; ++ring) {
    // Rings 0 .. ring - 1 cover everything nearer than this.
    const double covered = ring == 0 ? 0 : margin + (ring - 1) * cell_m_;
    if (covered > reach_m) break;
    if (count == out.size() && out[count - 1].square_m2 < covered * covered) break;
    for (int dy = -ring; dy <= ring; ++dy) {
      const bool whole_row = dy == -ring || dy == ring;
      for (int dx = -ring; dx <= ring; dx += whole_row || ring == 0 ? 1 : 2 * ring)
        visit_cell(column + dx, row + dy, id, reach_m * reach_m, out, count);
    }
  }
  return count;
}

}  // namespace throng
