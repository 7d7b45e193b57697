#include "culling/volumes/nearby_points.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace throng {
namespace {

using Eigen::Vector3f;

size_t nearest(std::span<const Vector3f> points, const Vector3f& to) {
  size_t best = 0;
  float least2 = std::numeric_limits<float>::max();
  for (size_t i = 0; i < points.size(); ++i) {
    const float apart2 = (points[i] - to).squaredNorm();
    if (apart2 >= least2) continue;
    least2 = apart2;
    best = i;
  }
  return best;
}

std::vector<Vector3f> subset_of(std::span<const Vector3f> points, size_t max_count) {
  const size_t step = (points.size() + max_count - 1) / max_count;
  std::vector<Vector3f> out;
  for (size_t i = 0; i < points.size(); i += step) out.push_back(points[i]);
  return out;
}

}  // namespace

NearbyPoints::NearbyPoints(std::span<const Vector3f> given) {
  assert(!given.empty());
  const std::vector<Vector3f> subset = subset_of(given, kMaxPoints);
  Vector3f low = subset.front(), high = subset.front();
  for (const Vector3f& point : subset) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const float edge_m = (high - low).maxCoeff() / float{kMaxCells};
  size_t stride = 1, cells[3];
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const float wide_m = high[i] - low[i];
    cells[axis] =
        edge_m > 0
            ? static_cast<size_t>(std::clamp(std::ceil(wide_m / edge_m), 1.0f, float{kMaxCells}))
            : 1;
    const auto count = static_cast<float>(cells[axis]);
    axes[axis] = {low[i], wide_m > 0 ? count / wide_m : 0, count - 1, static_cast<float>(stride)};
    stride *= cells[axis];
  }
  std::vector<uint16_t> place(subset.size(), std::numeric_limits<uint16_t>::max());
  const auto middle = [&](size_t axis, size_t cell) {
    const Axis& a = axes[axis];
    return a.per_m > 0 ? a.low_m + (static_cast<float>(cell) + 0.5f) / a.per_m : a.low_m;
  };
  for (size_t z = 0; z < cells[2]; ++z)
    for (size_t y = 0; y < cells[1]; ++y)
      for (size_t x = 0; x < cells[0]; ++x) {
        const size_t i = nearest(subset, {middle(0, x), middle(1, y), middle(2, z)});
        if (place[i] == std::numeric_limits<uint16_t>::max()) {
          place[i] = static_cast<uint16_t>(points.size());
          points.push_back({subset[i].x(), subset[i].y(), subset[i].z()});
        }
        point_of_cell.push_back(place[i]);
      }
}

Vector3f NearbyPoints::lookup(const Vector3f& place) const {
  float cell = 0;
  for (size_t i = 0; i < 3; ++i) {
    const float at = (place[static_cast<Eigen::Index>(i)] - axes[i].low_m) * axes[i].per_m;
    cell += std::floor(std::min(std::max(at, 0.0f), axes[i].last)) * axes[i].stride;
  }
  const Point& point = of_cell(static_cast<size_t>(cell));
  return {point.x, point.y, point.z};
}

}  // namespace throng
