// The four cells of a grid whose centres lie around a point, and the blend of what they hold.
// One rule: beyond the outermost centres it is the outermost cells' own.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

namespace throng {

struct CellPatch {
  size_t cell, right, above;  ///< the lower left one, and the steps from it: 0 at the rim
  float fx, fy;               ///< how far the point is from the first to the last

  /// Of a point in cells from the grid's corner.
  CellPatch(const Eigen::Vector2d& in_cells, int columns, int rows) {
    const double x = std::clamp(in_cells.x() - 0.5, 0.0, static_cast<double>(columns - 1));
    const double y = std::clamp(in_cells.y() - 0.5, 0.0, static_cast<double>(rows - 1));
    const auto column = static_cast<int>(x), row = static_cast<int>(y);
    cell = static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
    right = column + 1 < columns ? 1 : 0;
    above = row + 1 < rows ? static_cast<size_t>(columns) : 0;
    fx = static_cast<float>(x - column);
    fy = static_cast<float>(y - row);
  }

  /// at(cell) is what a cell holds.
  template <typename At>
  Eigen::Vector2f blend(const At& at) const {
    return (1 - fy) * ((1 - fx) * at(cell) + fx * at(cell + right)) +
           fy * ((1 - fx) * at(cell + above) + fx * at(cell + above + right));
  }
};

}  // namespace throng
