#include "viewer/picture/crowded.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace throng {
namespace {

bool overlap(const PlacedSphere& a, const PlacedSphere& b) {
  const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z, reach = a.radius + b.radius;
  return x * x + y * y + z * z <= reach * reach;
}

}  // namespace

/// Cells no smaller than the widest sphere, so that neighbours hold all partners.
struct Crowded::Grid {
  explicit Grid(std::span<const PlacedSphere> spheres) {
    float widest = 0;
    for (const PlacedSphere& s : spheres) {
      if (s.radius <= 0) continue;
      low_x = std::min(low_x, s.x), high_x = std::max(high_x, s.x);
      low_y = std::min(low_y, s.y), high_y = std::max(high_y, s.y);
      widest = std::max(widest, s.radius);
    }
    if (high_x < low_x) return;
    // A crowd spread thin over kilometres gets larger cells rather than millions of them.
    const float side = std::sqrt((high_x - low_x) * (high_y - low_y) / kMostCells);
    const float long_side = std::max(high_x - low_x, high_y - low_y) / kMostCells;
    edge = std::max({2 * widest, side, long_side, 1e-3F});
    columns = static_cast<int>((high_x - low_x) / edge) + 1;
    rows = static_cast<int>((high_y - low_y) / edge) + 1;
  }
  size_t cell(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
  }
  size_t cell(const PlacedSphere& s) const {
    return cell(std::min(columns - 1, static_cast<int>((s.x - low_x) / edge)),
                std::min(rows - 1, static_cast<int>((s.y - low_y) / edge)));
  }
  static constexpr float kMostCells = 1 << 18;
  float low_x = 1e30F, high_x = -1e30F, low_y = 1e30F, high_y = -1e30F, edge = 1;
  int columns = 1, rows = 1;
};

void Crowded::sort_by_cell(std::span<const PlacedSphere> spheres, const Grid& grid) {
  start_.assign(static_cast<size_t>(grid.columns) * static_cast<size_t>(grid.rows) + 1, 0);
  cell_of_.resize(spheres.size());
  order_.resize(spheres.size());
  for (size_t i = 0; i < spheres.size(); ++i) {
    if (spheres[i].radius <= 0) continue;
    cell_of_[i] = static_cast<uint32_t>(grid.cell(spheres[i]));
    ++start_[cell_of_[i] + 1];
  }
  for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  next_ = start_;
  for (size_t i = 0; i < spheres.size(); ++i)
    if (spheres[i].radius > 0) order_[next_[cell_of_[i]]++] = static_cast<uint32_t>(i);
}

size_t Crowded::mark(std::span<const PlacedSphere> spheres, std::span<uint8_t> flags) {
  assert(flags.size() == spheres.size());
  std::fill(flags.begin(), flags.end(), uint8_t{0});
  const Grid grid(spheres);
  sort_by_cell(spheres, grid);
  size_t marked = 0;
  const auto meet = [&](uint32_t i, uint32_t j) {
    if ((flags[i] != 0 && flags[j] != 0) || !overlap(spheres[i], spheres[j])) return;
    marked += (flags[i] == 0 ? 1u : 0u) + (flags[j] == 0 ? 1u : 0u);
    flags[i] = flags[j] = 1;
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const size_t cell = grid.cell(column, row);
      for (uint32_t at = start_[cell]; at < start_[cell + 1]; ++at) {
        // The rest of this cell and the cell to its right lie one after the other; so do the three
        // of the next row.
        const uint32_t end = start_[grid.cell(std::min(column + 1, grid.columns - 1), row) + 1];
        for (uint32_t other = at + 1; other < end; ++other) meet(order_[at], order_[other]);
        if (row + 1 == grid.rows) continue;
        const uint32_t above = start_[grid.cell(std::max(column - 1, 0), row + 1)];
        const uint32_t last =
            start_[grid.cell(std::min(column + 1, grid.columns - 1), row + 1) + 1];
        for (uint32_t other = above; other < last; ++other) meet(order_[at], order_[other]);
      }
    }
  }
  return marked;
}

}  // namespace throng
