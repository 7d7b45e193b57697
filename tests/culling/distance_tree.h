// DistanceTree computes the distance of two surfaces with a tree of balls in double precision:
// simple, and fast enough for millions of pairs.
// Invariant: it shares only the distance of two triangles with the tested search, and this has a
// separate oracle (distance_oracle.h).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/pose.h"
#include "culling/body_type.h"
#include "culling/triangles/triangle_test.h"

namespace throng::test {

class DistanceTree {
 public:
  /// Needs at least one triangle.
  DistanceTree(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3i> triangles);
  explicit DistanceTree(const PartShape& part) : DistanceTree(part.points, part.triangles) {}

  /// Placed surface. Scale and pose as in base/pose.h.
  struct Placed {
    const DistanceTree* tree;
    const PartPose* pose;
    float scale;
  };
  /// Distance of surfaces that do not touch; infinite if more than `within_m`.
  static double distance(const Placed& a, const Placed& b, const Eigen::Vector3d& a_to_b_m,
                         double within_m);
  /// The same by all pairs of triangles.
  static double distance_by_all(const Placed& a, const Placed& b, const Eigen::Vector3d& a_to_b_m);

 private:
  struct Ball {
    Eigen::Vector3d middle;
    double radius;
    size_t first, end;           ///< its triangles
    size_t left = 0, right = 0;  ///< 0: leaf
  };
  size_t add(size_t first, size_t end);

  std::vector<Triangle> triangles_;
  std::vector<Ball> balls_;
};

}  // namespace throng::test
