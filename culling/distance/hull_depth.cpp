#include "culling/distance/hull_depth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "culling/distance/placed_points.h"
#include "culling/distance/simplex.h"

namespace throng {
namespace {

/// How finely a depth is looked for.
struct Fineness {
  /// How much farther than a face the hull may reach and count as known there.
  double gap_m;
  /// Half the edge of a cube that is added to the difference of the hulls, so that there is a
  /// volume even where both are flat. Gap and half its diagonal together bound the error.
  double cube_m;
};
constexpr Fineness kCoarse{4e-4, 2e-5};
/// For depths that may be none at all.
constexpr Fineness kFine{1e-7, 1e-7};
constexpr double kMayBeNone_m = 1e-3;
/// No pair of bodies comes near; a pair that does gets the bounds that were found by then.
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

/// Four points that span a volume, found each as the farthest from what the ones before span; fewer
/// where the cloud has no volume to speak of.
std::vector<Eigen::Index> spread_corners(const Points& points, double least_m) {
  std::vector<Eigen::Index> out = {0};
  const Eigen::Vector3d origin = points.row(0);
  Points left = points.rowwise() - origin.transpose();  // less the parts along those found
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Index next = 0;
    const double far = std::sqrt(left.rowwise().squaredNorm().maxCoeff(&next));
    if (far <= least_m) break;
    out.push_back(next);
    const Eigen::Vector3d along = left.row(next).transpose() / far;
    left -= (left * along) * along.transpose();
  }
  return out;
}

/// Corners of a polytope that all points lie within `gap_m` of, as indices.
std::vector<Eigen::Index> corners_of(const Points& points, double gap_m) {
  std::vector<Eigen::Index> found = spread_corners(points, 100 * gap_m);
  std::vector<char> is_in(static_cast<size_t>(points.rows()), 0);
  if (found.size() < 4) {  // flat: all of them
    found.resize(is_in.size());
    for (size_t i = 0; i < found.size(); ++i) found[i] = static_cast<Eigen::Index>(i);
    return found;
  }
  GrowingPolytope hull;
  hull.start(
      {points.row(found[0]), points.row(found[1]), points.row(found[2]), points.row(found[3])});
  for (const Eigen::Index corner : found) is_in[static_cast<size_t>(corner)] = 1;
  // Until no face has a point before it.
  for (size_t at = 0; at < hull.faces().size(); ++at) {
    const GrowingPolytope::Face face = hull.faces()[at];
    if (face.settled || face.is_thin()) continue;
    const Eigen::Index far = farthest(points, points.rows(), face.normal);
    if (is_in[static_cast<size_t>(far)] ||
        face.normal.dot(points.row(far)) <= face.distance + gap_m) {
      hull.settle(at);
      continue;
    }
    is_in[static_cast<size_t>(far)] = 1;
    found.push_back(far);
    hull.add(points.row(far));
    at = static_cast<size_t>(-1);  // faces have moved
  }
  return found;
}

}  // namespace

ConvexHull::ConvexHull(std::span<const Eigen::Vector3f> points)
    : points_(static_cast<Eigen::Index>(points.size()), 3) {
  assert(!points.empty());
  for (size_t i = 0; i < points.size(); ++i)
    points_.row(static_cast<Eigen::Index>(i)) = points[i].cast<double>();
  const double size_m = (points_.colwise().maxCoeff() - points_.colwise().minCoeff()).maxCoeff();
  beyond_corners_m_ = kShare * size_m;
  std::vector<Eigen::Index> corners = corners_of(points_, beyond_corners_m_);
  std::sort(corners.begin(), corners.end());
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

// An expanding polytope (van den Bergen 2001) with two changes. It lies inside the difference of
// the hulls from the start, but need not hold the origin: the face whose plane is lowest is pushed
// out, and where the difference ends before the origin does, the hulls are apart. And a small cube
// is added to the difference, so that flat hulls need no cases of their own.
Depth find_depth(const PlacedPoints& a, const PlacedPoints& b, const Fineness& fineness,
                 GrowingPolytope& inside, std::vector<Eigen::Vector3d>& on_a) {
  const auto cube = [&](const Eigen::Vector3d& n) { return cube_corner(n, fineness.cube_m); };
  const Eigen::Vector3d first = a.support(b.shift - a.shift);
  const Eigen::Vector3d middle = first - b.support(a.shift - b.shift);
  on_a.assign(4, first);
  inside.start({middle + cube({1, 1, 1}), middle + cube({1, -1, -1}), middle + cube({-1, 1, -1}),
                middle + cube({-1, -1, 1})});
  Depth out;
  double least = std::numeric_limits<double>::infinity();
  for (;;) {
    const std::span<const GrowingPolytope::Face> faces = inside.faces();
    const auto lowest =
        std::min_element(faces.begin(), faces.end(),
                         [](const auto& p, const auto& q) { return p.distance < q.distance; });
    const Eigen::Vector3d normal = lowest->normal;
    const double inner = lowest->distance;
    const Eigen::Vector3d far_on_a = a.support(normal);
    const Eigen::Vector3d far = far_on_a - b.support(-normal);
    if (const double reach = normal.dot(far); reach < least) {
      least = reach;
      out.direction = normal;
    }
    const Eigen::Vector3d corner = far + cube(normal);
    const bool is_known = normal.dot(corner) - inner <= fineness.gap_m;
    if (least > 0 && !is_known && inside.points().size() < kMostCorners && inside.add(corner)) {
      on_a.push_back(far_on_a);
      continue;
    }
    out.at_least_m = std::max(0.0, inner - std::sqrt(3.0) * fineness.cube_m);
    // The corners left out count, too.
    out.depth_m = std::max(0.0, a.extent(out.direction) + b.extent(-out.direction));
    out.points_m = points_of(*lowest, inside.points(), on_a);
    return out;
  }
}

}  // namespace

Depth DepthFinder::depth(const PlacedHull& a, const PlacedHull& b,
                         const Eigen::Vector3f& a_to_b_m) {
  const PlacedPoints placed_a(a), placed_b(b, a_to_b_m.cast<double>());
  Depth coarse = find_depth(placed_a, placed_b, kCoarse, inside_, on_a_);
  if (coarse.depth_m == 0 || coarse.depth_m > kMayBeNone_m) return coarse;
  return find_depth(placed_a, placed_b, kFine, inside_, on_a_);
}

}  // namespace throng
