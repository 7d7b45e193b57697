// depth_by_all_directions() computes penetration depths by brute force. The difference of two hulls
// can rest on planes of their faces, or on planes along an edge of each. It tries all of these.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "tests/culling/shapes.h"

namespace throng::test {

using Cloud = std::vector<Eigen::Vector3d>;

/// Candidates for face normals and edges. Additional candidates are harmless.
struct HullDirections {
  std::vector<Eigen::Vector3d> normals;
  std::vector<std::array<Eigen::Vector3d, 2>> edges;
};

/// Every plane through three points and every line through two; for a few points.
inline HullDirections all_directions(const Cloud& cloud) {
  HullDirections out;
  for (size_t i = 0; i < cloud.size(); ++i)
    for (size_t j = i + 1; j < cloud.size(); ++j) {
      out.edges.push_back({cloud[i], cloud[j]});
      for (size_t k = j + 1; k < cloud.size(); ++k)
        out.normals.push_back((cloud[j] - cloud[i]).cross(cloud[k] - cloud[i]));
    }
  return out;
}

/// Displacement of B along n (unit) in either direction that separates it from A, or any value
/// above `enough` if it exceeds that.
inline double depth_along(const Cloud& a, const Cloud& b, const Eigen::Vector3d& n, double enough) {
  double a_low = n.dot(a[0]), a_high = a_low;
  double b_low = n.dot(b[0]), b_high = b_low;
  const auto depth = [&] { return std::min(a_high - b_low, b_high - a_low); };
  for (size_t i = 0; i < std::max(a.size(), b.size()) && depth() <= enough; ++i) {
    const double at_a = n.dot(a[std::min(i, a.size() - 1)]);
    const double at_b = n.dot(b[std::min(i, b.size() - 1)]);
    a_low = std::min(a_low, at_a);
    a_high = std::max(a_high, at_a);
    b_low = std::min(b_low, at_b);
    b_high = std::max(b_high, at_b);
  }
  return depth();
}

/// True if the differences of points of A and of B are coplanar.
inline bool is_flat(const Cloud& a, const Cloud& b) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Cloud* cloud : {&a, &b})
    for (const Eigen::Vector3d& p : *cloud)
      spread += (p - cloud->front()) * (p - cloud->front()).transpose();
  const Eigen::Vector3d size = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
  return size[0] <= 1e-14 * size[2];
}

/// Exact except for rounding. Directions are in the frame of the clouds.
inline double depth_by_all_directions(const Cloud& a, const HullDirections& of_a, const Cloud& b,
                                      const HullDirections& of_b) {
  if (is_flat(a, b)) return 0;
  double min_depth = std::numeric_limits<double>::infinity();
  const auto take = [&](const Eigen::Vector3d& n) {
    const double length = n.norm();
    if (length > 0) min_depth = std::min(min_depth, depth_along(a, b, n / length, min_depth));
  };
  for (const HullDirections* each : {&of_a, &of_b})
    for (const Eigen::Vector3d& normal : each->normals) take(normal);
  for (const auto& p : of_a.edges)
    for (const auto& q : of_b.edges) take((p[1] - p[0]).cross(q[1] - q[0]));
  return std::max(0.0, min_depth);
}

}  // namespace throng::test
