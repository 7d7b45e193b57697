#include "culling/distance/support_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace throng {
namespace {

using Eigen::Vector3d;

/// Of an angle that a direction may lie beyond the edge of its cell, by rounding.
constexpr double kAngleRounding = 1e-9;

/// Where a cell lies: its middle, unit, and the sine of the angle to the farthest of its corners.
struct Cone {
  Vector3d middle;
  double sine;
};

Cone cone_of(size_t cell, int side) {
  const size_t per_face = static_cast<size_t>(side) * static_cast<size_t>(side);
  const size_t face = cell / per_face, row = cell % per_face / static_cast<size_t>(side),
               column = cell % static_cast<size_t>(side);
  const auto axis = static_cast<Eigen::Index>(face / 2);
  const auto at = [&](double u, double v) {
    Vector3d out;
    out[axis] = face % 2 == 0 ? 1 : -1;
    out[(axis + 1) % 3] = 2 * (static_cast<double>(row) + u) / side - 1;
    out[(axis + 2) % 3] = 2 * (static_cast<double>(column) + v) / side - 1;
    return Vector3d(out.normalized());
  };
  Cone out{at(0.5, 0.5), 0};
  for (const double u : {0.0, 1.0})
    for (const double v : {0.0, 1.0})
      out.sine = std::max(out.sine, at(u, v).cross(out.middle).norm() + kAngleRounding);
  return out;
}

}  // namespace

size_t SupportMap::cell_of(const Vector3d& direction) {
  Eigen::Index axis = 0;
  const double most = direction.cwiseAbs().maxCoeff(&axis);
  if (!(most > 0)) return 0;  // along nothing all are as far
  const auto along = [&](Eigen::Index other) {
    const double share = direction[other] / most;  // -1 to 1
    return static_cast<size_t>(
        std::clamp(static_cast<int>((share + 1) * (0.5 * kSide)), 0, kSide - 1));
  };
  const size_t face = 2 * static_cast<size_t>(axis) + (direction[axis] < 0 ? 1 : 0);
  return (face * kSide + along((axis + 1) % 3)) * kSide + along((axis + 2) % 3);
}

SupportMap::SupportMap(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points,
                       Eigen::Index corners) {
  if (corners <= kFewCorners || corners > kMostCorners) return;
  start_.reserve(kCells + 1);
  for (size_t cell = 0; cell < kCells; ++cell) add_cell(points, corners, cell);
  start_.push_back(static_cast<uint32_t>(corners_.size()));
}

/// A corner is left out where another is farther along every direction of the cell: the angle from
/// the way between them to the cell's middle exceeds a right angle by more than the cell's own.
void SupportMap::add_cell(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points,
                          Eigen::Index corners, size_t cell) {
  const Cone cone = cone_of(cell, kSide);
  const auto is_behind = [&](Eigen::Index one, Eigen::Index other) {
    const Vector3d between = points.row(one) - points.row(other);
    return between.dot(cone.middle) < -cone.sine * between.norm();
  };
  start_.push_back(static_cast<uint32_t>(corners_.size()));
  Eigen::Index farthest = 0;
  (points.topRows(corners) * cone.middle).maxCoeff(&farthest);
  std::vector<Eigen::Index> left;
  for (Eigen::Index corner = 0; corner < corners; ++corner)
    if (!is_behind(corner, farthest)) left.push_back(corner);
  for (const Eigen::Index corner : left)
    if (std::none_of(left.begin(), left.end(),
                     [&](Eigen::Index other) { return is_behind(corner, other); }))
      corners_.push_back(static_cast<uint16_t>(corner));
}

}  // namespace throng
