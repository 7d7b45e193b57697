// NeighbourSearch is the search of a NeighbourGrid, one function per SIMD target.
// Invariant: the scalar loop is the definition; the others return the same results.
#pragma once

#include <algorithm>
#include <span>

#include "crowd/neighbours/neighbour_grid.h"

namespace throng {

/// The square of cells around a point, ring by ring.
struct Rings {
  Rings(const GridView& grid, size_t slot)
      : grid_(grid), column_(column_of(grid, grid.x[slot])), row_(row_of(grid, grid.y[slot])) {
    // Minimum distance of the point to the border of its cell. A point off the ground counts as
    // moved onto it, which only brings it closer to others.
    const float u = grid.x[slot] - grid.low_x - grid.cell_m * static_cast<float>(column_);
    const float v = grid.y[slot] - grid.low_y - grid.cell_m * static_cast<float>(row_);
    const float inside = std::min(std::min(u, grid.cell_m - u), std::min(v, grid.cell_m - v));
    margin_m_ = std::max(0.0f, inside) - grid.slack_m;
  }

  /// Lower bound of the distance to agents outside the rings 0 .. ring; `reach_m` at the end.
  float covered_m(int ring, float reach_m) const {
    const bool all = column_ - ring <= 0 && row_ - ring <= 0 &&
                     column_ + ring >= grid_.columns - 1 && row_ + ring >= grid_.rows - 1;
    return all ? reach_m
               : std::min(reach_m,
                          std::max(0.0f, static_cast<float>(ring) * grid_.cell_m + margin_m_));
  }

  /// Calls visit(first slot, last slot + 1) for each row of the rings 0 .. ring.
  template <typename Visit>
  void for_rows(int ring, const Visit& visit) const {
    const int left = std::max(0, column_ - ring);
    const int right = std::min(grid_.columns - 1, column_ + ring);
    for (int row = std::max(0, row_ - ring); row <= std::min(grid_.rows - 1, row_ + ring); ++row) {
      const uint32_t* cells = grid_.starts + static_cast<ptrdiff_t>(row) * grid_.columns;
      visit(cells[left], cells[right + 1]);
    }
  }

 private:
  const GridView& grid_;
  int column_;
  int row_;
  float margin_m_ = 0;
};

void nearest_scalar(const GridView& grid, std::span<const uint32_t> slots, float reach_m,
                    uint32_t* found, uint8_t* counts);
using NeighbourSearch = decltype(&nearest_scalar);
/// Returns the fastest search with the same results.
NeighbourSearch neighbour_search_on(SimdTarget target);

}  // namespace throng
