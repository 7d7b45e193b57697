// Simplex finds the point of a segment, triangle or tetrahedron nearest to the origin, and the
// corners around it (Ericson, Real-Time Collision Detection, 2005, 5.1).
// Invariant: weights are those of the returned point, at least 0, with a sum of 1; corners without
// weight are removed.
#pragma once

#include <Eigen/Core>
#include <array>

namespace throng {

/// Corner weights of the point of a triangle (possibly degenerate) nearest to the origin.
std::array<double, 3> weights_of_nearest(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                         const Eigen::Vector3d& c);

/// Up to four points, each a difference of a point of B and a point of A.
struct Simplex {
  struct Corner {
    Eigen::Vector3d between, on_a, on_b;
  };
  std::array<Corner, 4> corners;
  std::array<double, 4> weights{};
  int count = 0;

  void add(const Eigen::Vector3d& on_a, const Eigen::Vector3d& on_b) {
    corners[static_cast<size_t>(count++)] = {on_b - on_a, on_a, on_b};
  }
  /// Returns the point nearest to the origin and keeps its corners; all four if this is inside.
  Eigen::Vector3d reduce();
};

}  // namespace throng
