// The point nearest to the origin of a segment, triangle or tetrahedron, and the corners that it
// lies between (Ericson, Real-Time Collision Detection, 2005, 5.1).
// One rule: the weights are those of the point that is returned, never below 0, and add up to 1;
// corners without weight are left out.
#pragma once

#include <Eigen/Core>
#include <array>

namespace throng {

/// Of the point of a triangle nearest to the origin: the weights of its corners. May be flat.
std::array<double, 3> weights_of_nearest(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                         const Eigen::Vector3d& c);

/// Up to four points, each the difference of a point of B and a point of A.
struct Simplex {
  struct Corner {
    Eigen::Vector3d between, on_a, on_b;
  };
  std::array<Corner, 4> corners;
  std::array<double, 4> weights{};  ///< of the nearest point
  int count = 0;

  void add(const Eigen::Vector3d& on_a, const Eigen::Vector3d& on_b) {
    corners[static_cast<size_t>(count++)] = {on_b - on_a, on_a, on_b};
  }
  /// Leaves the corners that the nearest point lies between; all four where the origin is inside.
  Eigen::Vector3d reduce();
};

}  // namespace throng
