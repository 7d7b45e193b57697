#include "culling/volumes/ordop.h"

#include <cmath>

#include "culling/volumes/polytope.h"
#include "culling/volumes/pose_math.h"
#include "culling/volumes/slabs.h"

namespace throng {
namespace {

/// One half of the test: face normals of one body against the bound of the other.
template <int K>
bool separated(const Slabs& own, float own_scale, const Slabs& other, float other_scale,
               const Eigen::Matrix3f& other_from_own, const Eigen::Vector3f& own_to_other,
               float margin_m) {
  for (int i = 0; i < 13; ++i) {
    if (!has_direction(K, i)) continue;
    const Eigen::Vector3f n = direction_vector(i);
    const Slab& own_slab = own.slab[static_cast<size_t>(i)];
    const Eigen::Vector3f d(along(n, other_from_own.row(0)), along(n, other_from_own.row(1)),
                            along(n, other_from_own.row(2)));
    const Slab bound = other.bound<K>(d);
    const float between =
        along(n, own_to_other) + other_scale * bound.centre - own_scale * own_slab.centre;
    const float reach =
        own_scale * own_slab.half + other_scale * bound.half + margin_m * direction_length(i);
    if (std::fabs(between) > reach) return true;
  }
  return false;
}

}  // namespace

template <int K>
bool ordop_overlaps(const Slabs& slabs_a, const PartPose& pose_a, float scale_a,
                    const Slabs& slabs_b, const PartPose& pose_b, float scale_b,
                    const Eigen::Vector3f& a_to_b_m, float margin_m) {
  const Eigen::Vector3f delta = a_to_b_m + translation_m(pose_b) - translation_m(pose_a);
  Eigen::Matrix3f b_from_a;  // R_b^T R_a
  for (int column = 0; column < 3; ++column)
    b_from_a.col(column) = rotated_back(
        pose_b, {pose_a.rows[0][column], pose_a.rows[1][column], pose_a.rows[2][column]});
  if (separated<K>(slabs_a, scale_a, slabs_b, scale_b, b_from_a, rotated_back(pose_a, delta),
                   margin_m))
    return false;
  return !separated<K>(slabs_b, scale_b, slabs_a, scale_a, b_from_a.transpose(),
                       -rotated_back(pose_b, delta), margin_m);
}

template <int K>
double Ordop<K>::volume_m3(const Slabs& fitted) {
  return polytope_of(fitted, K).volume_m3;
}

#define THRONG_INSTANTIATE(K)                                                             \
  template bool ordop_overlaps<K>(const Slabs&, const PartPose&, float, const Slabs&,     \
                                  const PartPose&, float, const Eigen::Vector3f&, float); \
  template double Ordop<K>::volume_m3(const Slabs&);
THRONG_INSTANTIATE(14)
THRONG_INSTANTIATE(18)
THRONG_INSTANTIATE(26)
#undef THRONG_INSTANTIATE

}  // namespace throng
