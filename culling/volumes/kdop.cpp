#include "culling/volumes/kdop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "culling/volumes/polytope.h"
#include "culling/volumes/pose_math.h"
#include "culling/volumes/slabs.h"

namespace throng {
template <int K>
Slabs Kdop<K>::place(const Slabs& fitted, const PartPose& pose, float scale) {
  Slabs out;
  for (size_t i = 0; i < kDirections.size(); ++i) {
    if (!has_direction(K, static_cast<int>(i))) continue;
    const Eigen::Vector3f n = direction_vector(static_cast<int>(i));
    const Slab bound = fitted.bound<K>(rotated_back(pose, n));
    out.slab[i] = {scale * bound.centre + along(n, translation_m(pose)), scale * bound.half};
  }
  return out;
}

template <int K>
Slabs Kdop<K>::refit(std::span<const Eigen::Vector3f> points, const PartPose& pose, float scale) {
  std::array<float, 13> low, high;
  low.fill(std::numeric_limits<float>::infinity());
  high.fill(-std::numeric_limits<float>::infinity());
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3f q = placed_point(pose, scale, p);
    for (size_t i = 0; i < kDirections.size(); ++i) {
      if (!has_direction(K, static_cast<int>(i))) continue;
      const float h = along(direction_vector(static_cast<int>(i)), q);
      low[i] = std::min(low[i], h);
      high[i] = std::max(high[i], h);
    }
  }
  Slabs out;
  for (size_t i = 0; i < kDirections.size(); ++i)
    if (has_direction(K, static_cast<int>(i)))
      out.slab[i] = {0.5f * (low[i] + high[i]), 0.5f * (high[i] - low[i])};
  return out;
}

template <int K>
bool Kdop<K>::overlaps(const Slabs& a, const Slabs& b, const Eigen::Vector3f& a_to_b_m,
                       float margin_m) {
  for (size_t i = 0; i < kDirections.size(); ++i) {
    if (!has_direction(K, static_cast<int>(i))) continue;
    const Eigen::Vector3f n = direction_vector(static_cast<int>(i));
    const float between = along(n, a_to_b_m) + b.slab[i].centre - a.slab[i].centre;
    const float reach =
        a.slab[i].half + b.slab[i].half + margin_m * direction_length(static_cast<int>(i));
    if (std::fabs(between) > reach) return false;
  }
  return true;
}

template <int K>
double Kdop<K>::volume_m3(const Slabs& fitted) {
  return polytope_of(fitted, K).volume_m3;
}

template struct Kdop<14>;
template struct Kdop<18>;
template struct Kdop<26>;

}  // namespace throng
