// NearbyPoints looks up a point of a part near a position, for upper bounds of distances.
// Invariant: the result is one of the given points, so the distance to it is never too short.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

/// Grid over the part's box. Each cell stores the point nearest to its centre; positions outside
/// belong to the border cells. In the part's frame, in metres; kernels read it.
struct NearbyPoints {
  static constexpr int kMaxCells = 16;  ///< maximum number along the longest axis

  /// Cell of x along an axis: (x - low_m) * per_m, rounded down, from 0 to last.
  struct Axis {
    float low_m, per_m, last;
    float stride;  ///< index step between cells along this axis: a whole number
  };
  /// Point as a kernel loads it.
  struct alignas(16) Point {
    float x, y, z, unused = 0;
  };

  Axis axes[3];
  std::vector<Point> points;            ///< points of the cells
  std::vector<uint16_t> point_of_cell;  ///< index into `points`

  /// `points`: at least one. Of more than kMaxPoints only a subset is used.
  explicit NearbyPoints(std::span<const Eigen::Vector3f> points);

  /// Point of the cell of `place`; kernels do the same per lane.
  Eigen::Vector3f lookup(const Eigen::Vector3f& place) const;
  const Point& of_cell(size_t cell) const { return points[point_of_cell[cell]]; }

 private:
  static constexpr size_t kMaxPoints = 2048;
};

}  // namespace throng
