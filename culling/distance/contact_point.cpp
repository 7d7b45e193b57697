#include "culling/distance/contact_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "culling/distance/triangle_distance.h"
#include "culling/exact/touching_triangles.h"

namespace throng {
namespace {

using Eigen::Vector3d;

/// Sums up where the edges of one triangle go through the other.
struct Crossings {
  Vector3d sum = Vector3d::Zero();
  int count = 0;

  void add(const Triangle& edges, const Triangle& face) {
    const Vector3d u = face.corner[1] - face.corner[0], v = face.corner[2] - face.corner[0];
    const Vector3d normal = u.cross(v);
    const double squared = normal.squaredNorm();
    if (!(squared > 0)) return;
    for (int i = 0; i < 3; ++i) {
      const Vector3d &p = edges.corner[i], &q = edges.corner[(i + 1) % 3];
      const double before = normal.dot(p - face.corner[0]), after = normal.dot(q - face.corner[0]);
      if (before == after || (before > 0) == (after > 0)) continue;
      const Vector3d at = p + before / (before - after) * (q - p), r = at - face.corner[0];
      const double s = normal.dot(r.cross(v)) / squared, t = normal.dot(u.cross(r)) / squared;
      if (s < 0 || t < 0 || s + t > 1) continue;
      sum += at;
      ++count;
    }
  }
};

/// Of two triangles that touch: the middle of the segment that they share, or, where they lie in
/// one plane or touch by a corner, of their nearest points.
Vector3d shared_point(const Triangle& a, const Triangle& b) {
  Crossings crossings;
  crossings.add(a, b);
  crossings.add(b, a);
  if (crossings.count > 0) return crossings.sum / crossings.count;
  const NearestPoints nearest = triangle_gap(a, b).points;
  return 0.5 * (nearest.on_a + nearest.on_b);
}

/// The nearest to a target first.
struct NearestFirst {
  struct Rank {
    double a2 = 0, b2 = 0;  ///< squared, to the box of each, in A's unit of length
    double both() const { return std::max(a2, b2); }
  };
  Vector3d in_a, in_b;    ///< the target in the frame of each
  double a_from_b2;       ///< squared: B's unit of length in A's
  const double& nearer2;  ///< squared: only what is nearer is looked at

  Rank with_a(Rank rank, const TriangleBvh::Node& node) const {
    return {squared_to_box(node, in_a), rank.b2};
  }
  Rank with_b(Rank rank, const TriangleBvh::Node& node) const {
    return {rank.a2, a_from_b2 * squared_to_box(node, in_b)};
  }
  bool is_open(Rank rank) const { return rank.both() < nearer2; }
  static bool is_before(Rank one, Rank other) { return one.both() < other.both(); }
};

}  // namespace

std::optional<Vector3d> contact_point(const PlacedSurface& a, const PlacedSurface& b,
                                      const Eigen::Vector3f& a_to_b_m, const Vector3d& near_m,
                                      ExactCounters& counters) {
  const Relative a_from_b(*a.pose, a.scale, *b.pose, b.scale, a_to_b_m);
  const double ratio = static_cast<double>(b.scale) / static_cast<double>(a.scale);
  const Eigen::Matrix3d linear = scaled_rotation(*a.pose, a.scale);
  const Vector3d target = linear.inverse() * (near_m - translation(*a.pose));
  const double worth = kNearer_m / static_cast<double>(a.scale);
  std::optional<Vector3d> best;
  double best_far = std::numeric_limits<double>::infinity(), nearer2 = best_far;
  const TouchingTriangles triangles(*a.surface, *b.surface, a_from_b, ratio, counters);
  triangles.visit(
      [&](const Triangle& ta, const Triangle& tb) {
        const Vector3d point = shared_point(ta, tb);
        const double far = (point - target).norm();
        if (far < best_far) {
          best = point;
          best_far = far;
          nearer2 = std::pow(std::max(0.0, far - worth), 2);
        }
        return false;
      },
      NearestFirst{target, a_from_b.inverse * (target - a_from_b.offset), ratio * ratio, nearer2});
  if (!best) best = piece_inside(*a.surface, *b.surface, a_from_b);
  if (!best) return std::nullopt;
  return linear * *best + translation(*a.pose);
}

}  // namespace throng
