// hull_corners() chooses the points of a cloud that its convex hull rests on (Barber, Dobkin &
// Huhdanpaa, The Quickhull algorithm for convex hulls, ACM TOMS 22(4), 1996).
// Invariant: every point lies within the gap of the hull of the corners, however the points lie,
// and the work is bounded.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace throng {

/// Tests of a point against a plane, per point, after which all points that are still in front of
/// a face become corners. Spheres, the worst of usual clouds, take a twentieth.
inline constexpr size_t kMaxHullTestsPerPoint = 2000;

struct HullCorners {
  std::vector<Eigen::Index> indices;  ///< ascending, each once
  size_t tests = 0;                   ///< of a point against a plane
  size_t max_faces = 0;               ///< at once: fewer than two per point
  bool is_complete = true;            ///< false: the tests ran out
};

/// `points`: at least one, a column a coordinate, metres. `gap_m`: above 0, at least 1e-8 of the
/// size of the cloud, unless that is 0. Takes O(n log n) for usual clouds of n points, never more
/// than `max_tests_per_point` allows.
HullCorners hull_corners(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, double gap_m,
                         size_t max_tests_per_point = kMaxHullTestsPerPoint);

}  // namespace throng
