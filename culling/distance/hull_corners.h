// hull_corners() chooses the points of a cloud that its convex hull rests on.
// Method: Barber, Dobkin & Huhdanpaa, The Quickhull algorithm for convex hulls, ACM TOMS 22(4),
// 1996.
// Invariant: every point lies within the gap of the hull of the corners, for any points, and the
// work is bounded.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace throng {

/// Maximum number of tests of a point against a plane, per point. Beyond it all points in front of
/// a face become corners. Spheres, the worst of usual clouds, need a twentieth.
inline constexpr size_t kMaxHullTestsPerPoint = 2000;

struct HullCorners {
  std::vector<Eigen::Index> indices;  ///< ascending, each once
  size_t tests = 0;                   ///< number of tests of a point against a plane
  size_t max_faces = 0;               ///< maximum number at a time: fewer than two per point
  bool is_complete = true;            ///< false: the maximum number of tests was reached
};

/// `points`: at least one row, in metres. `gap_m`: above 0, at least 1e-8 of the size of the cloud.
/// Takes O(n log n) for usual clouds of n points, never more than `max_tests_per_point` allows.
HullCorners hull_corners(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, double gap_m,
                         size_t max_tests_per_point = kMaxHullTestsPerPoint);

}  // namespace throng
