// Distance of two meshes by brute force: every triangle of one against every triangle of the other.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "avatars/mesh/mesh.h"

namespace throng {

inline constexpr double kFar_m = std::numeric_limits<double>::infinity();
using TriangleM = std::array<Eigen::Vector3d, 3>;

inline double point_segment_m(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                              const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0;
  return (a + t * along - p).norm();
}

/// Distance to the face if p lies over it; otherwise infinity, because the edges decide.
inline double point_face_m(const Eigen::Vector3d& p, const TriangleM& t) {
  const Eigen::Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  if (!(normal.norm() > 0)) return kFar_m;
  for (size_t i = 0; i < 3; ++i)
    if (normal.cross(t[(i + 1) % 3] - t[i]).dot(p - t[i]) < 0) return kFar_m;
  return std::abs(normal.normalized().dot(p - t[0]));
}

inline double segments_m(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  double min_m = std::min({point_segment_m(a, c, d), point_segment_m(b, c, d),
                           point_segment_m(c, a, b), point_segment_m(d, a, b)});
  const Eigen::Vector3d u = b - a, v = d - c, normal = u.cross(v);
  if (normal.squaredNorm() < 1e-24) return min_m;
  // Nearest points of the lines, if they lie within both segments.
  const double s = (c - a).cross(v).dot(normal) / normal.squaredNorm();
  const double t = (c - a).cross(u).dot(normal) / normal.squaredNorm();
  if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
    min_m = std::min(min_m, (a + s * u - (c + t * v)).norm());
  return min_m;
}

inline bool crosses(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const TriangleM& t) {
  const Eigen::Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double from = normal.dot(a - t[0]), to = normal.dot(b - t[0]);
  if (from * to > 0 || from == to) return false;
  return point_face_m(a + from / (from - to) * (b - a), t) < kFar_m;
}

inline double triangles_m(const TriangleM& a, const TriangleM& b) {
  double min_m = kFar_m;
  for (size_t i = 0; i < 3; ++i) {
    if (crosses(a[i], a[(i + 1) % 3], b) || crosses(b[i], b[(i + 1) % 3], a)) return 0;
    min_m = std::min({min_m, point_face_m(a[i], b), point_face_m(b[i], a)});
    for (size_t k = 0; k < 3; ++k)
      min_m = std::min(min_m, segments_m(a[i], a[(i + 1) % 3], b[k], b[(k + 1) % 3]));
  }
  return min_m;
}

/// Infinity if the distance exceeds `max_m`. A solid inside another counts by the distance of the
/// surfaces.
inline double meshes_m(const Mesh& a, const Eigen::Affine3d& world_from_a, const Mesh& b,
                       const Eigen::Affine3d& world_from_b, double max_m) {
  struct Placed {
    TriangleM triangle;
    Eigen::AlignedBox3d box;
  };
  const auto placed = [](const Mesh& mesh, const Eigen::Affine3d& pose) {
    std::vector<Placed> out;
    for (const Eigen::Vector3i& t : mesh.triangles) {
      Placed one;
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3f& vertex = mesh.vertices[static_cast<size_t>(t[i])];
        one.triangle[static_cast<size_t>(i)] = pose * vertex.cast<double>();
        one.box.extend(one.triangle[static_cast<size_t>(i)]);
      }
      out.push_back(one);
    }
    return out;
  };
  double min_m = kFar_m;
  const std::vector<Placed> all_b = placed(b, world_from_b);
  for (const Placed& one : placed(a, world_from_a))
    for (const Placed& other : all_b)
      if (one.box.exteriorDistance(other.box) <= std::min(min_m, max_m))
        min_m = std::min(min_m, triangles_m(one.triangle, other.triangle));
  return min_m <= max_m ? min_m : kFar_m;
}

}  // namespace throng
