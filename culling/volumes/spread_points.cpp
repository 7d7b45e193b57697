#include "culling/volumes/spread_points.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <vector>

namespace throng {

SpreadPoints::SpreadPoints(std::span<const Eigen::Vector3f> points) {
  assert(!points.empty());
  std::vector<float> apart2(points.size(), std::numeric_limits<float>::max());
  size_t next = 0;
  for (size_t i = 0; i < kCount; ++i) {
    const Eigen::Vector3f& point = points[next];
    x[i] = point.x();
    y[i] = point.y();
    z[i] = point.z();
    for (size_t p = 0; p < points.size(); ++p)
      apart2[p] = std::min(apart2[p], (points[p] - point).squaredNorm());
    next = static_cast<size_t>(std::max_element(apart2.begin(), apart2.end()) - apart2.begin());
  }
}

}  // namespace throng
