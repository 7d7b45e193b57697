#include "culling/volumes/ordop_table.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "culling/volumes/pose_math.h"
#include "culling/volumes/slabs.h"

namespace throng {
namespace {

/// Interval of values, half width rounded up.
Slab around(double low, double high, bool centred) {
  const float centre = centred ? 0 : static_cast<float>(0.5 * (low + high));
  const double half =
      std::max(high - static_cast<double>(centre), static_cast<double>(centre) - low);
  return {centre, std::nextafter(static_cast<float>(half), std::numeric_limits<float>::max())};
}

}  // namespace

OrdopTable::OrdopTable(std::span<const Eigen::Vector3f> points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : points) box.extend(p.cast<double>());
  // Gives flat parts a negligible thickness.
  const double thinnest = std::max(1e-4 * box.sizes().maxCoeff(), 1e-6);
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    origin[axis] = static_cast<float>(box.center()[i]);
    half_box[axis] = static_cast<float>(std::max(0.5 * box.sizes()[i], thinnest));
    per_half_box[axis] = 1.0f / half_box[axis];
  }
  for (size_t d = 0; d < kDirections.size(); ++d) {
    double low = std::numeric_limits<double>::infinity(), high = -low, length2 = 0;
    for (const Eigen::Vector3f& p : points) {
      double at = 0;
      for (size_t axis = 0; axis < 3; ++axis)
        at += kDirections[d][axis] * ((static_cast<double>(p[static_cast<Eigen::Index>(axis)]) -
                                       static_cast<double>(origin[axis])) /
                                      static_cast<double>(half_box[axis]));
      low = std::min(low, at);
      high = std::max(high, at);
    }
    for (size_t axis = 0; axis < 3; ++axis)
      length2 += std::abs(kDirections[d][axis]) /
                 (static_cast<double>(half_box[axis]) * static_cast<double>(half_box[axis]));
    slabs.slab[d] = around(low, high, d < static_cast<size_t>(kAxisDirections));
    length[d] =
        std::nextafter(static_cast<float>(std::sqrt(length2)), std::numeric_limits<float>::max());
  }
  // Equal already, except for flat parts and the last bit.
  const float half = std::max({slabs.slab[0].half, slabs.slab[1].half, slabs.slab[2].half});
  for (size_t axis = 0; axis < 3; ++axis) slabs.slab[axis].half = half;
  fill_lookups();
  fill_inverses();
}

OrdopTable::OrdopTable(const Slabs& fitted) {
  for (size_t axis = 0; axis < 3; ++axis) {
    origin[axis] = fitted.slab[axis].centre;
    half_box[axis] = per_half_box[axis] = 1;
  }
  for (size_t d = 0; d < kDirections.size(); ++d) {
    double moved = static_cast<double>(fitted.slab[d].centre);
    for (size_t axis = 0; axis < 3; ++axis)
      moved -= kDirections[d][axis] * static_cast<double>(origin[axis]);
    const double half = static_cast<double>(fitted.slab[d].half);
    slabs.slab[d] = around(moved - half, moved + half, d < static_cast<size_t>(kAxisDirections));
    length[d] = direction_length(static_cast<int>(d));
  }
  fill_lookups();
  fill_inverses();
}

void OrdopTable::fill_lookups() {
  std::fill_n(edge_half + 24, 8, 0.0f);
  std::fill_n(edge_centre + 24, 8, 0.0f);
  for (size_t entry = 0; entry < 16; ++entry) {
    const bool negative[3] = {(entry & 1) != 0, (entry & 2) != 0, (entry & 4) != 0};
    for (size_t omitted = 0; omitted < 3; ++omitted) {
      const size_t first = omitted == 0 ? 1 : 0, second = omitted == 2 ? 1 : 2;
      const Slab& slab = slabs.slab[edge_direction(omitted, negative[first] != negative[second])];
      edge_half[omitted * 8 + entry % 8] = slab.half;
      edge_centre[omitted * 8 + entry % 8] = negative[first] ? -slab.centre : slab.centre;
    }
    const Slab& slab =
        slabs.slab[corner_direction(negative[1] != negative[0], negative[2] != negative[0])];
    corner_half[entry] = slab.half;
    corner_centre[entry] = negative[0] ? -slab.centre : slab.centre;
  }
}

void OrdopTable::fill_inverses() {
  // A part as thin as the rounding would have an infinite inverse reach.
  constexpr float kMinHalfWidth = 1e-6f;
  holds_origin = true;
  for (size_t d = 0; d < kDirections.size(); ++d) {
    const Slab& slab = slabs.slab[d];
    per_length[d] = 1 / length[d];
    per_reach_up[d] = 1 / (slab.centre + slab.half);
    per_reach_down[d] = 1 / (slab.centre - slab.half);
    holds_origin &= slab.half - std::abs(slab.centre) > kMinHalfWidth;
  }
}

namespace {

Eigen::Vector3f centre_m(const OrdopTable& table, const PartPose& pose, float scale) {
  const Eigen::Vector3f origin(scale * table.origin[0], scale * table.origin[1],
                               scale * table.origin[2]);
  return translation_m(pose) + rotated(pose, origin);
}

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
        rotated_back(pose_b, {pose_a.rows[0][j], pose_a.rows[1][j], pose_a.rows[2][j]});
    for (int i = 0; i < 3; ++i) {
      from_a.other_from_own[i][j] = b_from_a[i] * b_over_a;
      from_b.other_from_own[j][i] = b_from_a[i] * a_over_b;
    }
  }
  store(rotated_back(pose_a, delta) * per_a, from_a.offset);
  store(-rotated_back(pose_b, delta) * per_b, from_b.offset);
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
