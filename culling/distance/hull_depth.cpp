#include "culling/distance/hull_depth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "culling/distance/hull_corners.h"
#include "culling/distance/placed_points.h"
#include "culling/distance/simplex.h"

namespace throng {
namespace {

/// Pairs of bodies need some tens, two balls in each other of 10 000 corners each some thousands; a
/// pair that needs more gets the bounds that were found by then.
constexpr size_t kMostCorners = 20'000;

/// The corner of the cube that lies farthest along a direction.
Eigen::Vector3d cube_corner(const Eigen::Vector3d& direction, double half_m) {
  return direction.unaryExpr([half_m](double x) { return x < 0 ? -half_m : half_m; });
}

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

Eigen::Index farthest(const Points& points, Eigen::Index count, const Eigen::Vector3d& direction) {
  constexpr Eigen::Index kBlock = 64;
  std::array<double, kBlock> along;
  double most = -std::numeric_limits<double>::infinity();
  Eigen::Index best = 0;
  for (Eigen::Index first = 0; first < count; first += kBlock) {
    const Eigen::Index block = std::min(kBlock, count - first);
    const double* x = points.data() + first;
    const double* y = x + points.rows();
    const double* z = y + points.rows();
    for (Eigen::Index i = 0; i < block; ++i)
      along[static_cast<size_t>(i)] =
          direction.x() * x[i] + direction.y() * y[i] + direction.z() * z[i];
    for (Eigen::Index i = 0; i < block; ++i) {
      if (along[static_cast<size_t>(i)] <= most) continue;
      most = along[static_cast<size_t>(i)];
      best = first + i;
    }
  }
  return best;
}

}  // namespace

ConvexHull::ConvexHull(std::span<const Eigen::Vector3f> points)
    : points_(static_cast<Eigen::Index>(points.size()), 3) {
  assert(!points.empty());
  for (size_t i = 0; i < points.size(); ++i)
    points_.row(static_cast<Eigen::Index>(i)) = points[i].cast<double>();
  const double size_m = (points_.colwise().maxCoeff() - points_.colwise().minCoeff()).maxCoeff();
  beyond_corners_m_ = kShare * size_m;
  reach_m_ = std::sqrt(points_.rowwise().squaredNorm().maxCoeff());
  const std::vector<Eigen::Index> corners = hull_corners(points_, beyond_corners_m_).indices;
  corner_count_ = static_cast<int>(corners.size());
  for (size_t i = 0; i < corners.size(); ++i)  // ascending, so that none is moved away
    points_.row(static_cast<Eigen::Index>(i)).swap(points_.row(corners[i]));
  supports_ = SupportMap(points_, corner_count_);
}

Eigen::Vector3d ConvexHull::support(const Eigen::Vector3d& direction) const {
  if (supports_.is_empty()) return points_.row(farthest(points_, corner_count_, direction));
  Eigen::Index best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (const uint16_t corner : supports_.along(direction)) {
    const double along = points_.row(corner).dot(direction);
    if (along <= most) continue;
    most = along;
    best = corner;
  }
  return points_.row(best);
}

double ConvexHull::extent(const Eigen::Vector3d& direction) const {
  return direction.dot(points_.row(farthest(points_, points_.rows(), direction)));
}

namespace {

/// Of A and of B, whose difference is where the face lies nearest to the origin.
NearestPoints points_of(const GrowingPolytope::Face& face,
                        std::span<const Eigen::Vector3d> differences,
                        std::span<const Eigen::Vector3d> on_a) {
  const std::array<double, 3> weights = weights_of_nearest(
      differences[face.corners[0]], differences[face.corners[1]], differences[face.corners[2]]);
  NearestPoints out{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (size_t i = 0; i < 3; ++i) {
    const uint32_t corner = face.corners[i];
    out.on_a += weights[i] * on_a[corner];
    out.on_b += weights[i] * (on_a[corner] - differences[corner]);
  }
  return out;
}

}  // namespace

/// How finely a depth is looked for.
struct DepthFinder::Fineness {
  /// How much farther than a face the hull may reach and count as known there.
  double gap_m;
  /// Half the edge of a cube that is added to the difference of the hulls, so that there is a
  /// volume even where both are flat. Gap and half its diagonal together bound the error.
  double cube_m;
};

uint32_t DepthFinder::lowest_face() {
  while (inside_.distances()[lowest_.front().slot] != lowest_.front().distance) {
    std::pop_heap(lowest_.begin(), lowest_.end());
    lowest_.pop_back();
  }
  return lowest_.front().slot;
}

// An expanding polytope (van den Bergen 2001) with two changes. It lies inside the difference of
// the hulls from the start, but need not hold the origin: the face whose plane is lowest is pushed
// out, and where the difference ends before the origin does, the hulls are apart. And a small cube
// is added to the difference, so that flat hulls need no cases of their own.
Depth DepthFinder::find(const PlacedPoints& a, const PlacedPoints& b, const Fineness& fineness) {
  const double reach_m = 2 * (a.reach_m() + b.reach_m() + fineness.cube_m) +
                         (b.shift - a.shift).norm();  // floats turn a little askew
  const double grid_m = GrowingPolytope::grid_m(reach_m);
  const double cube_m = std::max(fineness.cube_m, 4 * grid_m);
  const auto cube = [&](const Eigen::Vector3d& n) { return cube_corner(n, cube_m); };
  const auto put = [&](uint32_t slot) {
    lowest_.push_back({inside_.distances()[slot], slot});
    std::push_heap(lowest_.begin(), lowest_.end());
  };
  const Eigen::Vector3d first = a.support(b.shift - a.shift);
  const Eigen::Vector3d middle = first - b.support(a.shift - b.shift);
  on_a_.assign(4, first);
  inside_.start({middle + cube({1, 1, 1}), middle + cube({1, -1, -1}), middle + cube({-1, 1, -1}),
                 middle + cube({-1, -1, 1})},
                reach_m);
  lowest_.clear();
  for (uint32_t slot = 0; slot < 4; ++slot) put(slot);
  Depth out;
  double least = std::numeric_limits<double>::infinity();
  for (;;) {
    const uint32_t lowest = lowest_face();
    const Eigen::Vector3d normal = inside_.faces()[lowest].normal;
    const double inner = inside_.distances()[lowest];
    const Eigen::Vector3d far_on_a = a.support(normal);
    const Eigen::Vector3d far = far_on_a - b.support(-normal);
    if (const double reach = normal.dot(far); reach < least) {
      least = reach;
      out.direction = normal;
    }
    const Eigen::Vector3d corner = far + cube(normal);
    const bool is_known = normal.dot(corner) - inner <= fineness.gap_m;
    if (least > 0 && !is_known && inside_.points().size() < kMostCorners &&
        inside_.add(corner, lowest)) {
      on_a_.push_back(far_on_a);
      for (const uint32_t slot : inside_.added()) put(slot);
      continue;
    }
    out.at_least_m = std::max(0.0, inner - std::sqrt(3.0) * (cube_m + grid_m));
    // The corners left out count, too.
    out.depth_m = std::max(0.0, a.extent(out.direction) + b.extent(-out.direction));
    out.points_m = points_of(inside_.faces()[lowest], inside_.points(), on_a_);
    return out;
  }
}

Depth DepthFinder::depth(const PlacedHull& a, const PlacedHull& b,
                         const Eigen::Vector3f& a_to_b_m) {
  constexpr Fineness kCoarse{4e-4, 2e-5};
  // For depths that may be none at all.
  constexpr Fineness kFine{1e-7, 1e-7};
  constexpr double kMayBeNone_m = 1e-3;
  const PlacedPoints placed_a(a), placed_b(b, a_to_b_m.cast<double>());
  Depth coarse = find(placed_a, placed_b, kCoarse);
  if (coarse.depth_m == 0 || coarse.depth_m > kMayBeNone_m) return coarse;
  return find(placed_a, placed_b, kFine);
}

}  // namespace throng
