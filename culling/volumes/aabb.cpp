#include "culling/volumes/aabb.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "culling/volumes/pose_math.h"

namespace throng {
namespace {

/// Centre and half widths. Half widths are rounded up to cover both ends from the rounded centre.
Aabb::Fitted between(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  Aabb::Fitted box;
  for (int i = 0; i < 3; ++i) {
    const double l = static_cast<double>(low[i]), h = static_cast<double>(high[i]);
    box.centre_m[i] = static_cast<float>(0.5 * (l + h));
    const double c = static_cast<double>(box.centre_m[i]);
    box.half_m[i] = std::nextafter(static_cast<float>(std::max(h - c, c - l)),
                                   std::numeric_limits<float>::max());
  }
  return box;
}

}  // namespace

Aabb::Fitted Aabb::fit(std::span<const Eigen::Vector3f> points) {
  assert(!points.empty());
  Eigen::Vector3f low = points[0], high = points[0];
  for (const Eigen::Vector3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return between(low, high);
}

Aabb::Placed Aabb::place(const Fitted& fitted, const PartPose& pose, float scale) {
  Placed box;
  box.centre_m = placed_point(pose, scale, fitted.centre_m);
  const Eigen::Vector3f half = scale * fitted.half_m;
  for (int i = 0; i < 3; ++i)
    box.half_m[i] = std::fabs(pose.rows[i][0]) * half.x() + std::fabs(pose.rows[i][1]) * half.y() +
                    std::fabs(pose.rows[i][2]) * half.z();
  return box;
}

Aabb::Placed Aabb::refit(std::span<const Eigen::Vector3f> points, const PartPose& pose,
                         float scale) {
  assert(!points.empty());
  Eigen::Vector3f low = placed_point(pose, scale, points[0]), high = low;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3f q = placed_point(pose, scale, p);
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  return between(low, high);
}

bool Aabb::overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                    float margin_m) {
  const Eigen::Vector3f between_centres = a_to_b_m + b.centre_m - a.centre_m;
  const Eigen::Vector3f reach = a.half_m + b.half_m;
  return std::fabs(between_centres.x()) <= reach.x() + margin_m &&
         std::fabs(between_centres.y()) <= reach.y() + margin_m &&
         std::fabs(between_centres.z()) <= reach.z() + margin_m;
}

double Aabb::volume_m3(const Fitted& fitted) { return 8 * fitted.half_m.cast<double>().prod(); }

}  // namespace throng
