// part_distance() computes the distance of two posed bodies, or of some of their parts, on request.
// Invariant: both bounds are proven. With triangles they equal those of ProximityRows bit for bit.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "base/pose.h"
#include "culling/body_type.h"
#include "culling/pair.h"
#include "culling/proximity.h"

namespace throng {

/// Body in its current pose, with the parts to measure from.
struct BodyInPose {
  uint32_t id = 0;
  uint16_t type = 0;  ///< index into the body types
  float scale = 1;
  Eigen::Vector3d root_m = Eigen::Vector3d::Zero();
  std::span<const PartPose> poses;  ///< one per part of the type
  std::span<const uint8_t> parts;   ///< part numbers, at least one
};

/// Distance of the nearest two parts, part_a of body a and part_b of body b. Fields as in
/// ProximityPair. Without triangles `level` is kPartVolume, and points and normal are NaN.
struct PartDistance {
  uint8_t part_a = 0, part_b = 0;
  PairLevel level = PairLevel::kPartVolume;
  /// Lower and upper bound in metres; by triangles at most 1 mm apart, plus 3e-6 of the distance
  /// beyond kMaxProximity_m. Both are 0 if parts touch.
  float lo_m = 0, hi_m = 0;
  std::array<double, 3> point_a_m, point_b_m;
  std::array<float, 3> normal;
  float depth_m = 0;
};

/// `types`: those of the culler. The ids must differ (asserted). Thread-safe. Fits the volumes of
/// both types on first use.
PartDistance part_distance(std::span<const std::shared_ptr<const BodyType>> types,
                           const BodyInPose& a, const BodyInPose& b);

}  // namespace throng
