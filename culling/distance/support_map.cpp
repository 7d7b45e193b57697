#include "culling/distance/support_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

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

/// Whether a corner is behind another along every direction of a cone, by the way from the other.
struct Behind {
  explicit Behind(const Cone& cone) : middle(cone.middle), sine2(cone.sine * cone.sine) {}
  bool operator()(double x, double y, double z) const {
    const double along = middle.x() * x + middle.y() * y + middle.z() * z;
    return (along < 0) & (along * along > sine2 * (x * x + y * y + z * z));
  }
  Vector3d middle;
  double sine2;
};

/// Corners that are compared each with each: beyond, the time would grow with their square.
constexpr size_t kFewToCompare = 256;

constexpr double kEighth = std::numbers::pi / 4;

/// Unit directions around the middle of a cone, within it and beyond.
std::vector<Vector3d> directions_of(const Cone& cone) {
  std::vector<Vector3d> out;
  const Vector3d u = cone.middle.unitOrthogonal(), v = cone.middle.cross(u);
  for (const double tilt : {0.5 * cone.sine, 2 * cone.sine, 6 * cone.sine})
    for (int turn = 0; turn < 8; ++turn)
      out.push_back(
          (cone.middle + tilt * (std::cos(turn * kEighth) * u + std::sin(turn * kEighth) * v))
              .normalized());
  return out;
}

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
/// the way between them to the cell's middle exceeds a right angle by more than the cell's own. It
/// is compared with all others where they are few, else with the farthest along some directions.
void SupportMap::add_cell(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points,
                          Eigen::Index corners, size_t cell) {
  const Cone cone = cone_of(cell, kSide);
  start_.push_back(static_cast<uint32_t>(corners_.size()));
  Eigen::Index farthest = 0;
  (points.topRows(corners) * cone.middle).maxCoeff(&farthest);
  std::vector<Vector3d> places;
  std::vector<uint16_t> left;
  const Behind is_behind(cone);
  const double *x = points.data(), *y = x + points.rows(), *z = y + points.rows();
  for (Eigen::Index corner = 0; corner < corners; ++corner) {
    if (is_behind(x[corner] - x[farthest], y[corner] - y[farthest], z[corner] - z[farthest]))
      continue;
    left.push_back(static_cast<uint16_t>(corner));
    places.emplace_back(x[corner], y[corner], z[corner]);
  }
  const auto leave_out_behind = [&](const std::vector<Vector3d>& others) {
    size_t count = 0;
    const std::vector<Vector3d> all = places;
    for (size_t i = 0; i < left.size(); ++i) {
      const auto hides = [&](const Vector3d& other) {
        const Vector3d between = all[i] - other;
        return is_behind(between.x(), between.y(), between.z());
      };
      if (std::any_of(others.begin(), others.end(), hides)) continue;
      left[count] = left[i];
      places[count++] = all[i];
    }
    left.resize(count);
    places.resize(count);
  };
  if (left.size() > kFewToCompare) {
    std::vector<Vector3d> ahead;
    for (const Vector3d& direction : directions_of(cone))
      ahead.push_back(*std::max_element(places.begin(), places.end(),
                                        [&](const Vector3d& p, const Vector3d& q) {
                                          return p.dot(direction) < q.dot(direction);
                                        }));
    leave_out_behind(ahead);
  }
  if (left.size() <= kFewToCompare) leave_out_behind(std::vector(places));
  corners_.insert(corners_.end(), left.begin(), left.end());
}

}  // namespace throng
