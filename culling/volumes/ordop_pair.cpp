#include "culling/volumes/ordop_pair.h"

#include <cmath>
#include <limits>

#include "culling/volumes/pose_math.h"

namespace throng {
namespace {

/// Where the origin of a table's slabs lies, relative to the body's root.
Eigen::Vector3f centre_m(const OrdopTable& table, const PartPose& pose, float scale) {
  const Eigen::Vector3f origin(scale * table.origin[0], scale * table.origin[1],
                               scale * table.origin[2]);
  return translation_m(pose) + turned(pose, origin);
}

/// True if a direction of own separates it from other.
template <int K>
bool separates(const OrdopTable& own, const OrdopTable& other, const OrdopHalf& half) {
  const auto vector = [](const float(&v)[3]) { return Eigen::Vector3f(v[0], v[1], v[2]); };
  const Eigen::Vector3f rows[3] = {vector(half.other_from_own[0]), vector(half.other_from_own[1]),
                                   vector(half.other_from_own[2])};
  for (size_t i = 0; i < kDirections.size(); ++i) {
    if (!has_direction(K, static_cast<int>(i))) continue;
    const Eigen::Vector3f n = direction_vector(static_cast<int>(i));
    const Slab far =
        other.slabs.bound<K>({along(n, rows[0]), along(n, rows[1]), along(n, rows[2])});
    const Slab& near = own.slabs.slab[i];
    const float gap = std::fabs((along(n, vector(half.offset)) + far.centre) - near.centre);
    if (gap > (near.half + far.half) + half.margin * direction_length(static_cast<int>(i)))
      return true;
  }
  return false;
}

void store(const Eigen::Vector3f& from, float (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

}  // namespace

OrdopLanes::OrdopLanes(const Slabs& fitted, int k) : table(fitted) {
  for (size_t i = 0; i < kDirectionSlots; ++i) {
    const bool has = i < kDirections.size() && has_direction(k, static_cast<int>(i));
    centre[i] = has ? table.slabs.slab[i].centre : 0;
    half[i] = has ? table.slabs.slab[i].half : std::numeric_limits<float>::infinity();
  }
}

OrdopHalves::OrdopHalves(const OrdopTable& a, const PartPose& pose_a, float scale_a,
                         const OrdopTable& b, const PartPose& pose_b, float scale_b,
                         const float (&shift_m)[4]) {
  const Eigen::Vector3f shift(shift_m[0], shift_m[1], shift_m[2]);
  const Eigen::Vector3f delta = shift + centre_m(b, pose_b, scale_b) - centre_m(a, pose_a, scale_a);
  const float per_a = 1.0f / scale_a, per_b = 1.0f / scale_b;
  const float b_over_a = scale_b * per_a, a_over_b = scale_a * per_b;
  for (int j = 0; j < 3; ++j) {
    const Eigen::Vector3f b_from_a =
        turned_back(pose_b, {pose_a.rows[0][j], pose_a.rows[1][j], pose_a.rows[2][j]});
    for (int i = 0; i < 3; ++i) {
      from_a.other_from_own[i][j] = b_from_a[i] * b_over_a;
      from_b.other_from_own[j][i] = b_from_a[i] * a_over_b;
    }
  }
  store(turned_back(pose_a, delta) * per_a, from_a.offset);
  store(-turned_back(pose_b, delta) * per_b, from_b.offset);
  from_a.margin = shift_m[3] * per_a;
  from_b.margin = shift_m[3] * per_b;
}

template <int K>
bool ordop_pair(const OrdopLanes& a, const PartPose& pose_a, float scale_a, const OrdopLanes& b,
                const PartPose& pose_b, float scale_b, const float (&shift_m)[4]) {
  const OrdopHalves halves(a.table, pose_a, scale_a, b.table, pose_b, scale_b, shift_m);
  return !separates<K>(a.table, b.table, halves.from_a) &&
         !separates<K>(b.table, a.table, halves.from_b);
}

#define THRONG_INSTANTIATE(K)                                                               \
  template bool ordop_pair<K>(const OrdopLanes&, const PartPose&, float, const OrdopLanes&, \
                              const PartPose&, float, const float(&)[4]);
THRONG_INSTANTIATE(14)
THRONG_INSTANTIATE(18)
THRONG_INSTANTIATE(26)
#undef THRONG_INSTANTIATE

}  // namespace throng
