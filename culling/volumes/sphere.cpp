#include "culling/volumes/sphere.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "culling/volumes/pose_math.h"

namespace throng {
namespace {

struct Ball {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius2 = -1;  ///< squared radius; negative: empty ball

  /// Includes rounding, so that points on the surface are inside.
  bool contains(const Eigen::Vector3d& p) const {
    return (p - centre).squaredNorm() <= radius2 * (1 + 1e-12);
  }
};

struct Support {
  Eigen::Vector3d point[4];
  int count = 0;

  /// Smallest ball through all points: centre = p0 + sum l_i (p_i - p0), G l = diag(G) / 2. False
  /// if they are affinely dependent.
  bool ball(Ball& out) const {
    out = {};
    if (count == 0) return true;
    const int n = count - 1;
    Eigen::Matrix3d gram = Eigen::Matrix3d::Identity();
    Eigen::Vector3d half = Eigen::Vector3d::Zero();
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j)
        gram(i, j) = (point[i + 1] - point[0]).dot(point[j + 1] - point[0]);
      half[i] = 0.5 * gram(i, i);
    }
    Eigen::FullPivLU<Eigen::Matrix3d> lu(gram.topLeftCorner<3, 3>());
    if (n > 0 && n < 3) {  // unused rows are scaled to the used ones, for a correct rank
      for (int i = n; i < 3; ++i) gram(i, i) = gram(0, 0);
      lu.compute(gram);
    }
    lu.setThreshold(1e-11);
    if (!lu.isInvertible()) return false;
    const Eigen::Vector3d weight = lu.solve(half);
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    for (int i = 0; i < n; ++i) offset += weight[i] * (point[i + 1] - point[0]);
    out.centre = point[0] + offset;
    out.radius2 = offset.squaredNorm();
    return true;
  }
};

/// Smallest ball around the first `count` points with `support` on its surface. The recursion is
/// over the support only: at most four deep.
Ball smallest_ball(std::vector<Eigen::Vector3d>& points, size_t count, Support& support) {
  Ball ball;
  support.ball(ball);
  if (support.count == 4) return ball;
  for (size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d p = points[i];
    if (ball.contains(p)) continue;
    support.point[support.count++] = p;
    Ball through;
    if (support.ball(through)) {
      ball = smallest_ball(points, i, support);
      std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(i),
                  points.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    --support.count;
  }
  return ball;
}

}  // namespace

Sphere::Fitted Sphere::fit(std::span<const Eigen::Vector3f> points) {
  assert(!points.empty());
  std::vector<Eigen::Vector3d> exact(points.size());
  for (size_t i = 0; i < points.size(); ++i) exact[i] = points[i].cast<double>();
  Support support;
  const Ball ball = smallest_ball(exact, exact.size(), support);
  Fitted sphere;
  sphere.centre_m = ball.centre.cast<float>();
  // The radius is measured, so that it holds despite the rounding above.
  double radius = 0;
  for (const Eigen::Vector3f& p : points)
    radius = std::max(radius, (p.cast<double>() - sphere.centre_m.cast<double>()).norm());
  sphere.radius_m =
      radius == 0 ? 0.0f
                  : std::nextafter(static_cast<float>(radius), std::numeric_limits<float>::max());
  return sphere;
}

Sphere::Placed Sphere::place(const Fitted& fitted, const PartPose& pose, float scale) {
  return {placed_point(pose, scale, fitted.centre_m), scale * fitted.radius_m};
}

bool Sphere::overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                      float margin_m) {
  const Eigen::Vector3f d = a_to_b_m + b.centre_m - a.centre_m;
  const float reach = a.radius_m + b.radius_m + margin_m;
  return d.x() * d.x() + d.y() * d.y() + d.z() * d.z() <= reach * reach;
}

double Sphere::volume_m3(const Fitted& fitted) {
  const double r = static_cast<double>(fitted.radius_m);
  return 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

}  // namespace throng
