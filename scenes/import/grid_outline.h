// Grid outlines are the borders of the free cells of a grid as polygons with few vertices.
// Invariant: the centre of each free cell that is kept lies inside, all others lie outside; rings
// neither cross nor touch each other or themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/polygon.h"

namespace throng {

/// Cells in rows from the bottom; cell (x, y) covers [x, x + 1] by [y, y + 1].
struct CellGrid {
  int64_t width = 0, height = 0;
  std::vector<uint8_t> is_free;

  bool contains_free(int64_t x, int64_t y) const {
    return x >= 0 && y >= 0 && x < width && y < height &&
           is_free[static_cast<size_t>(y * width + x)] != 0;
  }
};

struct GridOutline {
  std::vector<Polygon> polygons;  ///< one per area that is kept; unit: cells
  int64_t areas_left_out = 0, cells_left_out = 0;
  bool is_too_detailed = false;  ///< there would be more than `max_vertices`; polygons are missing
};

/// Areas of free cells are joined by edges, not by corners. Those of fewer than `min_cells` cells,
/// or than a thousandth of the largest one, are left out; the largest one is kept.
/// Borders are straightened by at most half a cell. A straight wall becomes one edge at any angle,
/// and the corners of axis-aligned walls stay where they are.
GridOutline outline_of(CellGrid grid, int64_t min_cells, size_t max_vertices);

}  // namespace throng
