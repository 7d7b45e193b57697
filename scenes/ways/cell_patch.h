// The four cells of a grid whose centres lie around a point, and the blend of what they hold.
// One rule: beyond the outermost centres it is the outermost cells' own.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

namespace throng {

template <typename Real>
struct CellPatch {
  size_t cell, right, above;  ///< the lower left one, and the steps from it: 0 at the rim
  Real fx, fy;                ///< how far the point is from the first to the last

  /// Of a point in cells from the grid's corner.
  CellPatch(const Eigen::Vector2d& in_cells, int columns, int rows) {
    const double x = std::clamp(in_cells.x() - 0.5, 0.0, static_cast<double>(columns - 1));
    const double y = std::clamp(in_cells.y() - 0.5, 0.0, static_cast<double>(rows - 1));
    const auto column = static_cast<size_t>(x), row = static_cast<size_t>(y);
    const auto row_cells = static_cast<size_t>(columns);
    cell = row * row_cells + column;
    right = column + 1 < row_cells ? 1 : 0;
    above = row + 1 < static_cast<size_t>(rows) ? row_cells : 0;
    fx = static_cast<Real>(x - static_cast<double>(column));
    fy = static_cast<Real>(y - static_cast<double>(row));
  }

  /// at(cell) is what a cell holds.
  template <typename At>
  Eigen::Matrix<Real, 2, 1> blend(const At& at) const {
    return (1 - fy) * ((1 - fx) * at(cell) + fx * at(cell + right)) +
           fy * ((1 - fx) * at(cell + above) + fx * at(cell + above + right));
  }
};

}  // namespace throng
