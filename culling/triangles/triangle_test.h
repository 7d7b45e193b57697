// Whether two triangles touch: the last word on a contact. And where edges are nearest.
// One rule: closed sets, and doubt counts as touching - only a gap above the rounding separates.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace throng {

/// Corners in any frame that both triangles share. May be degenerate: a segment or a point.
struct Triangle {
  std::array<Eigen::Vector3d, 3> corner;
};

/// True if the closed triangles have a point in common. A gap below about 1e-13 of the largest
/// coordinate counts as touching (more for slivers, by as much as their normals are uncertain).
bool triangles_touch(const Triangle& a, const Triangle& b);

// The nearest points of two segments: of edges of triangles.
// One rule: the points lie on the segments whatever rounding does, so their distance is never below
// the true one by more than the rounding of a sum.

/// Of A and of B.
struct NearestPoints {
  Eigen::Vector3d on_a, on_b;
};

/// Of segment p + [0, 1] u and segment q + [0, 1] v (Ericson, Real-Time Collision Detection, 2005,
/// 5.1.9). Either may be a point.
inline NearestPoints nearest_of_segments(const Eigen::Vector3d& p, const Eigen::Vector3d& u,
                                         const Eigen::Vector3d& q, const Eigen::Vector3d& v) {
  const Eigen::Vector3d r = p - q;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), ur = u.dot(r),
               vr = v.dot(r);
  double s = 0, t = 0;
  const double determinant = uu * vv - uv * uv;
  if (uu > 0 && vv > 0) {
    s = determinant > 0 ? std::clamp((uv * vr - ur * vv) / determinant, 0.0, 1.0) : 0.0;
    t = (uv * s + vr) / vv;
    if (t < 0) {
      t = 0;
      s = std::clamp(-ur / uu, 0.0, 1.0);
    } else if (t > 1) {
      t = 1;
      s = std::clamp((uv - ur) / uu, 0.0, 1.0);
    }
  } else if (uu > 0) {
    s = std::clamp(-ur / uu, 0.0, 1.0);
  } else if (vv > 0) {
    t = std::clamp(vr / vv, 0.0, 1.0);
  }
  return {p + s * u, q + t * v};
}

/// Of edge i of A and edge j of B; an edge runs from its corner to the next.
inline NearestPoints nearest_of_segments(const Triangle& a, int i, const Triangle& b, int j) {
  return nearest_of_segments(a.corner[i], a.corner[(i + 1) % 3] - a.corner[i], b.corner[j],
                             b.corner[(j + 1) % 3] - b.corner[j]);
}

}  // namespace throng
