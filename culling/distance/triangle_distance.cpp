#include "culling/distance/triangle_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {
namespace {

using Eigen::Vector3d;

struct NearestPair {
  NearestPoints points;
  double squared = std::numeric_limits<double>::infinity();

  void take(const Vector3d& on_a, const Vector3d& on_b) {
    const double distance = (on_b - on_a).squaredNorm();
    if (distance < squared) {
      squared = distance;
      points = {on_a, on_b};
    }
  }
};

/// Calls visit(corner, point below it) for each corner of `from` above the face of `to`.
template <typename Visit>
void for_corners_over(const Triangle& from, const Triangle& to, const Visit& visit) {
  const Vector3d u = to.corner[1] - to.corner[0], v = to.corner[2] - to.corner[0];
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm();
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 0)) return;  // a segment: its edges suffice
  for (const Vector3d& corner : from.corner) {
    const Vector3d r = corner - to.corner[0];
    const double ru = r.dot(u), rv = r.dot(v);
    const double s = (vv * ru - uv * rv) / determinant, t = (uu * rv - uv * ru) / determinant;
    if (s >= 0 && t >= 0 && s + t <= 1) visit(corner, Vector3d(to.corner[0] + s * u + t * v));
  }
}

}  // namespace

double min_along(const Vector3d& axis, const Triangle& t) {
  return std::min({axis.dot(t.corner[0]), axis.dot(t.corner[1]), axis.dot(t.corner[2])});
}

double max_along(const Vector3d& axis, const Triangle& t) {
  return std::max({axis.dot(t.corner[0]), axis.dot(t.corner[1]), axis.dot(t.corner[2])});
}

double gap_along(const Vector3d& unit, const Triangle& a, const Triangle& b) {
  return std::max(0.0, min_along(unit, b) - max_along(unit, a));
}

/// Two disjoint triangles are nearest at two edges, or at a corner and a face.
TriangleGap triangle_gap(const Triangle& a, const Triangle& b) {
  NearestPair nearest;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const NearestPoints points = nearest_of_segments(a, i, b, j);
      nearest.take(points.on_a, points.on_b);
    }
  }
  for_corners_over(
      a, b, [&](const Vector3d& corner, const Vector3d& below) { nearest.take(corner, below); });
  for_corners_over(
      b, a, [&](const Vector3d& corner, const Vector3d& below) { nearest.take(below, corner); });
  TriangleGap out{nearest.points, std::sqrt(nearest.squared), 0};
  if (out.hi > 0) {
    const Vector3d axis = (out.points.on_b - out.points.on_a) / out.hi;
    out.lo = std::min(gap_along(axis, a, b), out.hi);
  }
  return out;
}

}  // namespace throng
