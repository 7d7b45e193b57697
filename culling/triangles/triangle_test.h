// triangles_touch() tests two triangles for a common point; nearest_of_segments() finds the nearest
// points of edges.
// Invariant: triangles are closed sets, and only a gap above the rounding error separates them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace throng {

/// Corners in any frame that both triangles share. May be degenerate: a segment or a point.
struct Triangle {
  std::array<Eigen::Vector3d, 3> corner;
};

/// True if the closed triangles have a common point. A gap below about 1e-13 of the largest
/// coordinate counts as touching (more for slivers, whose normals are less certain).
bool triangles_touch(const Triangle& a, const Triangle& b);

// Invariant of nearest_of_segments(): the points lie on the segments regardless of rounding. Their
// distance is below the true one at most by the rounding of a sum.

struct NearestPoints {
  Eigen::Vector3d on_a, on_b;
};

/// Nearest points of segments p + [0, 1] u and q + [0, 1] v (Ericson, Real-Time Collision
/// Detection, 2005, 5.1.9). Either may be a point.
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

/// Nearest points of edge i of A and edge j of B; edge i begins at corner i.
inline NearestPoints nearest_of_segments(const Triangle& a, int i, const Triangle& b, int j) {
  return nearest_of_segments(a.corner[i], a.corner[(i + 1) % 3] - a.corner[i], b.corner[j],
                             b.corner[(j + 1) % 3] - b.corner[j]);
}

}  // namespace throng
