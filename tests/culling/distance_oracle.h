// distance_oracle computes distances of triangles and surfaces by brute force.
#pragma once

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "culling/distance/triangle_distance.h"
#include "culling/triangles/triangle_bvh.h"
#include "tests/culling/random_bodies.h"

namespace throng::test {

/// Two triangles are nearest between a corner, an edge or the face of each. All 49 pairs of these
/// are tried as the flat spaces that they span. A pair counts if the points found are within both.
inline double triangle_distance_by_features(const Triangle& a, const Triangle& b) {
  static const std::vector<std::vector<int>> features = {{0},    {1},    {2},      {0, 1},
                                                         {1, 2}, {2, 0}, {0, 1, 2}};
  double min_distance = std::numeric_limits<double>::infinity();
  for (const std::vector<int>& fa : features) {
    for (const std::vector<int>& fb : features) {
      const auto free_a = static_cast<Eigen::Index>(fa.size()) - 1;
      const auto free_b = static_cast<Eigen::Index>(fb.size()) - 1;
      const Eigen::Vector3d &p = a.corner[fa[0]], &q = b.corner[fb[0]];
      Eigen::MatrixXd spans(3, free_a + free_b);
      for (Eigen::Index i = 0; i < free_a; ++i)
        spans.col(i) = a.corner[fa[static_cast<size_t>(i) + 1]] - p;
      for (Eigen::Index i = 0; i < free_b; ++i)
        spans.col(free_a + i) = q - b.corner[fb[static_cast<size_t>(i) + 1]];
      Eigen::VectorXd x = Eigen::VectorXd::Zero(free_a + free_b);
      if (x.size() > 0) x = spans.completeOrthogonalDecomposition().solve(q - p);
      constexpr double kSlack = 1e-9;
      const bool within = (x.array() >= -kSlack).all() && x.head(free_a).sum() <= 1 + kSlack &&
                          x.tail(free_b).sum() <= 1 + kSlack;
      if (!within) continue;
      Eigen::Vector3d between = q - p;
      if (x.size() > 0) between -= spans * x;
      min_distance = std::min(min_distance, between.norm());
    }
  }
  return min_distance;
}

/// Triangles of a placed part, relative to a root.
inline std::vector<Triangle> placed_triangles(const PartShape& part, const PartPose& pose,
                                              float scale, const Eigen::Vector3d& root_m) {
  std::vector<Triangle> out;
  const Eigen::Isometry3d there = to_isometry(pose);
  for (const Eigen::Vector3i& t : part.triangles) {
    Triangle placed;
    for (int c = 0; c < 3; ++c)
      placed.corner[c] = there * (static_cast<double>(scale) *
                                  part.points[static_cast<size_t>(t[c])].cast<double>()) +
                         root_m;
    out.push_back(placed);
  }
  return out;
}

/// True if the point is on the surface of a part, up to rounding, or inside its solid.
inline bool is_on_part(const Eigen::Vector3d& point_m, const PartShape& part,
                       const TriangleBvh& surface, const PartPose& pose, float scale,
                       const Eigen::Vector3d& root_m) {
  const Triangle there{{point_m, point_m, point_m}};
  for (const Triangle& t : placed_triangles(part, pose, scale, root_m))
    if (triangle_distance_by_features(t, there) < 1e-6) return true;
  const Eigen::Isometry3d placed = to_isometry(pose);
  return surface.contains(placed.linear().inverse() * (point_m - root_m - placed.translation()) /
                          static_cast<double>(scale));
}

/// Distance of surfaces that do not touch: every triangle against every other.
inline double surface_distance_by_brute_force(const std::vector<Triangle>& a,
                                              const std::vector<Triangle>& b) {
  double min_distance = std::numeric_limits<double>::infinity();
  for (const Triangle& ta : a)
    for (const Triangle& tb : b) min_distance = std::min(min_distance, triangle_gap(ta, tb).hi);
  return min_distance;
}

}  // namespace throng::test
