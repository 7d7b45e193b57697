#include "culling/triangles/triangle_test.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace throng {
namespace {

using Eigen::Vector3d;

/// Relative rounding of a product of lengths, 45 units: a projection is a sum of six products whose
/// factors were rounded a few times.
constexpr double kRounding = 1e-14;

double min3(double a, double b, double c) { return std::min(a, std::min(b, c)); }
double max3(double a, double b, double c) { return std::max(a, std::max(b, c)); }

bool separates(const Vector3d& axis, const Triangle& a, const Triangle& b, double tolerance) {
  const double a0 = axis.dot(a.corner[0]), a1 = axis.dot(a.corner[1]), a2 = axis.dot(a.corner[2]);
  const double b0 = axis.dot(b.corner[0]), b1 = axis.dot(b.corner[1]), b2 = axis.dot(b.corner[2]);
  return min3(b0, b1, b2) - max3(a0, a1, a2) > tolerance ||
         min3(a0, a1, a2) - max3(b0, b1, b2) > tolerance;
}

/// For segments and coplanar triangles, face normals and edge products do not suffice. The shortest
/// vector between disjoint triangles always separates them; in these cases it joins two edges.
bool shortest_vector_separates(const Triangle& a, const Triangle& b, double reach) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const NearestPoints points = nearest_of_segments(a, i, b, j);
      const Vector3d axis = points.on_b - points.on_a;
      if (separates(axis, a, b, kRounding * axis.norm() * reach)) return true;
    }
  }
  return false;
}

}  // namespace

bool triangles_touch(const Triangle& a, const Triangle& b) {
  const Vector3d ea[3] = {a.corner[1] - a.corner[0], a.corner[2] - a.corner[1],
                          a.corner[0] - a.corner[2]};
  const Vector3d eb[3] = {b.corner[1] - b.corner[0], b.corner[2] - b.corner[1],
                          b.corner[0] - b.corner[2]};
  // Squared lengths of the longest edges, and the largest coordinate.
  const double la2 = max3(ea[0].squaredNorm(), ea[1].squaredNorm(), ea[2].squaredNorm());
  const double lb2 = max3(eb[0].squaredNorm(), eb[1].squaredNorm(), eb[2].squaredNorm());
  double reach = 0;
  for (int i = 0; i < 3; ++i)
    reach = max3(reach, a.corner[i].cwiseAbs().maxCoeff(), b.corner[i].cwiseAbs().maxCoeff());

  const Vector3d na = ea[0].cross(ea[1]);
  if (separates(na, a, b, kRounding * la2 * reach)) return false;
  const Vector3d nb = eb[0].cross(eb[1]);
  if (separates(nb, a, b, kRounding * lb2 * reach)) return false;
  const double tolerance = kRounding * std::sqrt(la2 * lb2) * reach;
  for (const Vector3d& u : ea)
    for (const Vector3d& v : eb)
      if (separates(u.cross(v), a, b, tolerance)) return false;

  const double na2 = na.squaredNorm(), nb2 = nb.squaredNorm();
  const bool degenerate = na2 <= 1e-18 * la2 * la2 || nb2 <= 1e-18 * lb2 * lb2;
  if (degenerate || na.cross(nb).squaredNorm() <= 1e-12 * na2 * nb2)
    return !shortest_vector_separates(a, b, reach);
  return true;
}

}  // namespace throng
