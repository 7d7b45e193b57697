#include "culling/part_distance.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "culling/distance/proximity_candidates.h"
#include "culling/fitted.h"
#include "culling/kernels/kernels.h"
#include "culling/stages/pass.h"
#include "culling/stages/slots.h"

namespace throng {
namespace {

using Eigen::Vector3d;

constexpr float kFar_m = std::numeric_limits<float>::infinity();

/// Two bodies, the lower id first, as the rows of a culler have them.
class PosedPair {
 public:
  PosedPair(BodyTypes types, const BodyInPose& a, const BodyInPose& b)
      : a_(a), b_(b), type_a_(*types[a.type]), type_b_(*types[b.type]), bucket_(bucket(types)) {
    const Vector3d shift = b.root_m - a.root_m;
    a_to_b_m_ = shift.cast<float>();
    rounding_m_ = shift - a_to_b_m_.cast<double>();
    poses_.assign(a.poses.begin(), a.poses.end());
    poses_.insert(poses_.end(), b.poses.begin(), b.poses.end());
    bodies_ = {{a_to_b_m_.x(), a_to_b_m_.y(), a_to_b_m_.z(), margin_m(a) + margin_m(b)},
               a.scale,
               b.scale,
               0,
               static_cast<uint32_t>(a.poses.size()),
               0,
               0,
               0,
               1,
               a.type,
               b.type};
    for (const BodyType* type : {&type_a_, &type_b_}) fit_for_proximity(*type);
  }

  bool has_triangles() const { return type_a_.has_triangles() && type_b_.has_triangles(); }

  /// Every two of the parts, with bounds by or-DOPs, by increasing lower bound.
  std::vector<ProximityCandidate> candidates() const {
    std::vector<ProximityCandidate> out;
    for (const uint8_t part_a : a_.parts)
      for (const uint8_t part_b : b_.parts) out.push_back(candidate(part_a, part_b));
    std::sort(out.begin(), out.end(), [](const ProximityCandidate& p, const ProximityCandidate& q) {
      return std::pair(p.lo_m, p.parts()) < std::pair(q.lo_m, q.parts());
    });
    return out;
  }

  PartPair parts(const ProximityCandidate& c) const {
    return {{&type_a_.volumes(), c.part_a, &poses_[bodies_.pose_a + c.part_a], a_.scale},
            {&type_b_.volumes(), c.part_b, &poses_[bodies_.pose_b + c.part_b], b_.scale},
            a_to_b_m_,
            bodies_.shift_m[3]};
  }

  PartDistance distance(const ProximityCandidate& c, const DistanceResult& result) const {
    // Beyond the range of rows the vector between the roots and points of triangles lose digits.
    constexpr double kFarShare = 1e-6;
    const bool is_far = result.lo_m > static_cast<double>(kMaxProximity_m);
    const Vector3d rounding_m = is_far ? rounding_m_ : Vector3d::Zero();
    const double error_m = rounding_m.norm() + (is_far ? kFarShare * result.hi_m : 0);
    const Vector3d point_a = a_.root_m + result.on_a_m,
                   point_b = a_.root_m + result.on_b_m + rounding_m;
    PartDistance out = bounded(c, rounded_down(std::max(0.0, result.lo_m - error_m)),
                               rounded_up(result.hi_m + error_m));
    out.level = PairLevel::kTriangles;
    std::copy_n(point_a.data(), 3, out.point_a_m.begin());
    std::copy_n(point_b.data(), 3, out.point_b_m.begin());
    for (int axis = 0; axis < 3; ++axis)
      out.normal[static_cast<size_t>(axis)] = static_cast<float>(result.normal[axis]);
    out.depth_m = static_cast<float>(result.depth_m);
    return out;
  }

  static PartDistance bounded(const ProximityCandidate& c, float lo_m, float hi_m) {
    PartDistance out;
    out.part_a = c.part_a;
    out.part_b = c.part_b;
    out.lo_m = lo_m;
    out.hi_m = hi_m;
    out.point_a_m.fill(ProximityPair::kNoPosition);
    out.point_b_m.fill(ProximityPair::kNoPosition);
    out.normal.fill(ProximityPair::kUnknown);
    return out;
  }

 private:
  float margin_m(const BodyInPose& body) const {
    return body.scale * body_margin_m(reach_m(&body == &a_ ? type_a_ : type_b_));
  }

  /// Kernels get the part with the lower shape number first. The order changes the rounding.
  BucketRule bucket(BodyTypes types) const {
    std::vector<uint16_t> first_shape;
    size_t shapes = 0;
    for (const auto& type : types) {
      first_shape.push_back(static_cast<uint16_t>(std::min<size_t>(shapes, kMaxBucketShapes)));
      shapes += type->parts().size();
    }
    const BoxFrame frame{nullptr, nullptr, first_shape.data(),
                         static_cast<uint32_t>(std::min<size_t>(shapes, kMaxBucketShapes))};
    return {frame, a_.type, b_.type};
  }

  ProximityCandidate candidate(uint8_t part_a, uint8_t part_b) const {
    const Candidate one{0, part_a, part_b, bucket_(part_a, part_b)};
    const BodyType::Volumes &a = type_a_.volumes(), &b = type_b_.volumes();
    const OrdopTable *table_a = &a.tables()[part_a], *table_b = &b.tables()[part_b];
    const NearbyPoints *on_a = &a.nearby_points()[part_a], *on_b = &b.nearby_points()[part_b];
    if (one.is_swapped()) {
      std::swap(table_a, table_b);
      std::swap(on_a, on_b);
    }
    const uint32_t index = 0;
    GapBounds gap{0, kFar_m};
    uint8_t overlaps = 0;
    scalar_kernels().ordop_gaps(*table_a, *table_b, *on_a, *on_b, &bodies_, poses_.data(), &one,
                                &index, 1, kFar_m, &gap, &overlaps);
    return {gap.lo_m, gap.hi_m, part_a, part_b, TouchState::kUntested, true};
  }

  const BodyInPose &a_, &b_;
  const BodyType &type_a_, &type_b_;
  BucketRule bucket_;
  Eigen::Vector3f a_to_b_m_;
  Vector3d rounding_m_;
  std::vector<PartPose> poses_;
  BodyPair bodies_{};
};

/// Parts with the least upper bound. The lower bound is that of all parts.
PartDistance nearest_of(const PosedPair& pair) {
  const bool has_triangles = pair.has_triangles();
  TriangleQuery query;
  ProximityCounters counters;
  PartDistance nearest;
  nearest.hi_m = kFar_m;
  float min_distance_m = kFar_m;
  const auto take = [&](const PartDistance& one) {
    min_distance_m = std::min(min_distance_m, one.lo_m);
    if (std::tuple(one.hi_m, one.part_a, one.part_b) <
        std::tuple(nearest.hi_m, nearest.part_a, nearest.part_b))
      nearest = one;
  };
  for (ProximityCandidate& c : pair.candidates()) {
    if (c.lo_m > nearest.hi_m) break;
    const PartPair parts = pair.parts(c);
    if (has_triangles) {
      const DistanceResult result =
          query.decide(parts, c, static_cast<double>(nearest.hi_m), counters);
      if (result.is_within) take(pair.distance(c, result));
    } else {
      tighten_by_hulls(parts, c);
      take(PosedPair::bounded(c, c.lo_m, c.hi_m));
    }
  }
  nearest.lo_m = min_distance_m;
  return nearest;
}

PartDistance swapped(PartDistance distance) {
  std::swap(distance.part_a, distance.part_b);
  std::swap(distance.point_a_m, distance.point_b_m);
  for (float& axis : distance.normal) axis = -axis;
  return distance;
}

}  // namespace

PartDistance part_distance(std::span<const std::shared_ptr<const BodyType>> types,
                           const BodyInPose& a, const BodyInPose& b) {
  assert(a.id != b.id && !a.parts.empty() && !b.parts.empty());
  assert(a.poses.size() == types[a.type]->parts().size());
  assert(b.poses.size() == types[b.type]->parts().size());
  if (a.id > b.id) return swapped(nearest_of({types, b, a}));
  return nearest_of({types, a, b});
}

}  // namespace throng
