#include "culling/distance/hull_distance.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "culling/distance/placed_points.h"

namespace throng {
namespace {

using Eigen::Vector3d;

constexpr int kMostSteps = 32;
constexpr double kConverged_m = 1e-4;

/// Up to four points of the difference of the hulls.
struct Simplex {
  std::array<Vector3d, 4> points;
  int count = 0;
};

/// The point of the affine hull of origin and origin + edges that is nearest to zero; false if it
/// lies outside their convex hull, or the edges span less than their number.
template <int kEdges>
bool nearest_within(const Vector3d& origin, const std::array<Vector3d, 3>& edges,
                    Vector3d& nearest) {
  Eigen::Matrix<double, 3, kEdges> spans;
  for (int i = 0; i < kEdges; ++i) spans.col(i) = edges[static_cast<size_t>(i)];
  const Eigen::Matrix<double, kEdges, kEdges> products = spans.transpose() * spans;
  if (!(products.determinant() > 1e-14 * std::pow(products.trace(), kEdges))) return false;
  const Eigen::Matrix<double, kEdges, 1> weights =
      products.inverse() * (-(spans.transpose() * origin));
  if (weights.minCoeff() < 0 || weights.sum() > 1) return false;
  nearest = origin + spans * weights;
  return true;
}

bool nearest_of_subset(const Simplex& simplex, unsigned subset, Vector3d& nearest) {
  Vector3d origin = Vector3d::Zero();
  std::array<Vector3d, 3> edges = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  size_t size = 0;
  for (int i = 0; i < simplex.count; ++i) {
    if (((subset >> i) & 1u) == 0) continue;
    const Vector3d& point = simplex.points[static_cast<size_t>(i)];
    if (size++ == 0)
      origin = point;
    else
      edges[size - 2] = point - origin;
  }
  switch (size) {
    case 1:
      nearest = origin;
      return true;
    case 2:
      return nearest_within<1>(origin, edges, nearest);
    case 3:
      return nearest_within<2>(origin, edges, nearest);
    default:
      return nearest_within<3>(origin, edges, nearest);
  }
}

/// The point of the simplex that is nearest to the origin; leaves the corners that span it.
Vector3d reduce(Simplex& simplex) {
  Vector3d best = simplex.points[0];
  double least = std::numeric_limits<double>::infinity();
  unsigned kept = 1;
  for (unsigned subset = 1; subset < (1u << simplex.count); ++subset) {
    Vector3d nearest;
    if (!nearest_of_subset(simplex, subset, nearest)) continue;
    if (const double squared = nearest.squaredNorm(); squared < least) {
      least = squared;
      best = nearest;
      kept = subset;
    }
  }
  int count = 0;
  for (int i = 0; i < simplex.count; ++i)
    if ((kept >> i) & 1u)
      simplex.points[static_cast<size_t>(count++)] = simplex.points[static_cast<size_t>(i)];
  simplex.count = count;
  return best;
}

}  // namespace

HullGap hull_gap(const PlacedHull& a, const PlacedHull& b, const Eigen::Vector3f& a_to_b_m,
                 const Eigen::Vector3d& direction) {
  const PlacedPoints there_a(a), there_b(b, a_to_b_m.cast<double>());
  HullGap out;
  out.corners_m = std::numeric_limits<double>::max();
  Simplex simplex;
  Vector3d towards = direction, best = direction;
  double most = -std::numeric_limits<double>::infinity();
  out.about_m = std::numeric_limits<double>::max();
  for (int step = 0; step < kMostSteps; ++step) {
    const Vector3d between = there_b.support(-towards) - there_a.support(towards);
    out.corners_m = std::min(out.corners_m, between.norm());
    if (const double gap = towards.dot(between); gap > most) {
      most = gap;
      best = towards;
    }
    simplex.points[static_cast<size_t>(simplex.count++)] = between;
    const Vector3d nearest = reduce(simplex);
    const double distance = nearest.norm();
    const bool is_nearer = distance < out.about_m;
    out.about_m = std::min(out.about_m, distance);
    if (distance - most < kConverged_m || simplex.count == 4 || !is_nearer) break;
    towards = nearest / distance;
  }
  out.direction = best;
  if (most > 0) out.lo_m = std::max(0.0, -there_b.extent(-best) - there_a.extent(best));
  return out;
}

}  // namespace throng
