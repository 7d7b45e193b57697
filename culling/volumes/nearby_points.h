// A point of a part near any place, looked up: how near another part is at most can be read off it.
// One rule: it is one of the points that were given, so no distance to it is too short.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

/// Cells over the part's box, and of each the point that is nearest to its middle; a place outside
/// belongs to the cell at the border. In the part's own frame, metres; kernels read it.
struct NearbyPoints {
  static constexpr int kMaxCells = 16;  ///< along an axis: along the longest

  /// Of an axis: the cell of x is (x - low_m) * per_m, rounded down, from 0 to last.
  struct Axis {
    float low_m, per_m, last;
    float stride;  ///< from a cell to the next, in all cells: a whole number
  };
  /// As a kernel loads it.
  struct alignas(16) Point {
    float x, y, z, unused = 0;
  };

  Axis axes[3];
  std::vector<Point> points;            ///< those that a cell has
  std::vector<uint16_t> point_of_cell;  ///< by their number in `points`

  /// At least one point. Of more than kMaxPoints only some are taken.
  explicit NearbyPoints(std::span<const Eigen::Vector3f> points);

  /// That of the cell of `place`; kernels do the same in lanes.
  Eigen::Vector3f lookup(const Eigen::Vector3f& place) const;
  const Point& of_cell(size_t cell) const { return points[point_of_cell[cell]]; }

 private:
  static constexpr size_t kMaxPoints = 2048;
};

}  // namespace throng
