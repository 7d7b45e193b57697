// SIMD loops of body avoidance: eight constraints, times or shapes; register pairs of places.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "avatars/body_avoidance/body_avoidance_kernels.h"
#include "avatars/gait/gait_curves.h"
#include "base/portable_math.h"
#include "base/simd/dispatch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "avatars/body_avoidance/body_avoidance_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace THRONG_EIGHT_LANES {
namespace {

#include "base/simd/angles-inl.h"
//
#include "avatars/body_avoidance/clearance_constraints-inl.h"

}  // namespace
}  // namespace THRONG_EIGHT_LANES

AvoidanceMotion target_avoidance_simd(const BodyState2d& own,
                                      std::span<const BodyState2d* const> neighbours,
                                      std::span<const WallState2d> walls) {
  return THRONG_EIGHT_LANES::compute_target(own, neighbours, walls);
}

namespace register_pairs {
namespace {

#include "avatars/body_avoidance/leg_prediction-inl.h"

static_assert(kPlaces % kLaneCount == 0);

}  // namespace
}  // namespace register_pairs
#if HWY_MAX_BYTES > 16
namespace eight_lanes {
namespace {

#include "avatars/body_avoidance/leg_prediction-inl.h"

}  // namespace
}  // namespace eight_lanes
#endif

void predict_simd(const LegState& leg, const PlaceNumbers& ahead_s, size_t count,
                  PredictedLeg& predicted) {
  for (size_t i = 0; i < count; i += THRONG_EIGHT_LANES::kLaneCount)
    THRONG_EIGHT_LANES::predict_at(i, leg, ahead_s, predicted);
}

bool violates_clearance_simd(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                             const LegOwner& other_owner, float clearance_m, size_t count) {
  for (size_t i = 0; i < count; i += THRONG_EIGHT_LANES::kLaneCount)
    if (THRONG_EIGHT_LANES::violates_clearance_at(i, leg, own, other, other_owner, clearance_m))
      return true;
  return false;
}

bool predict_clearance_simd(const LegState& leg, const PlaceNumbers& ahead_s, const LegPlaces& own,
                            const LegQuery& query, LegClearance& predicted) {
  static_assert(THRONG_EIGHT_LANES::kLaneCount == kPredictionTimes);
  return THRONG_EIGHT_LANES::predict_clearance_at(0, leg, ahead_s, own, query, predicted);
}

void add_clearance_cost_simd(const LegPlaces& places, const LegOwner& own,
                             std::span<const OtherLeg> others, float clearance_m,
                             PlaceNumbers& costs) {
  for (size_t i = 0; i < kPlaces; i += register_pairs::kLaneCount)
    register_pairs::add_clearance_cost_at(i, places, own, others, clearance_m, costs);
}

void add_cadence_cost_simd(const CadenceCandidates& cadences, const std::array<LegState, 2>& own,
                           std::span<const PredictedLegs> others, float clearance_m,
                           CadenceNumbers& costs) {
  static_assert(kCadences % THRONG_EIGHT_LANES::kLaneCount == 0);
  for (size_t i = 0; i < kCadences; i += THRONG_EIGHT_LANES::kLaneCount)
    THRONG_EIGHT_LANES::add_cadence_cost_at(i, cadences, own, others, clearance_m, costs);
}

namespace THRONG_EIGHT_LANES {
namespace {

#include "avatars/body_avoidance/upper_body_bounds-inl.h"

static_assert(kLaneCount == kShapeLanes);

}  // namespace
}  // namespace THRONG_EIGHT_LANES

bool find_upper_box_simd(const UpperBodyBounds::Shapes& shapes, std::span<const PartPose> poses,
                         const RoundBounds& all, RootBox& box) {
  return THRONG_EIGHT_LANES::upper_box(shapes, poses, all, box);
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

AvoidanceMotion target_avoidance(const BodyState2d& own,
                                 std::span<const BodyState2d* const> neighbours,
                                 std::span<const WallState2d> walls, SimdTarget target) {
  assert(neighbours.size() <= kMaxAvoidedBodies && walls.size() <= kMaxAvoidedWalls);
  return THRONG_CHOOSE(target, target_avoidance_simd, target_avoidance_scalar)(own, neighbours,
                                                                               walls);
}

void predict(const LegState& leg, const PlaceNumbers& ahead_s, size_t count, SimdTarget target,
             PredictedLeg& predicted) {
  THRONG_CHOOSE(target, predict_simd, predict_scalar)(leg, ahead_s, count, predicted);
}

bool violates_clearance(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                        const LegOwner& other_owner, float clearance_m, size_t count,
                        SimdTarget target) {
  return THRONG_CHOOSE(target, violates_clearance_simd, violates_clearance_scalar)(
      leg, own, other, other_owner, clearance_m, count);
}

bool predict_clearance(const LegState& leg, const PlaceNumbers& ahead_s, const LegPlaces& own,
                       const LegQuery& query, SimdTarget target, LegClearance& predicted) {
  return THRONG_CHOOSE(target, predict_clearance_simd, predict_clearance_scalar)(leg, ahead_s, own,
                                                                                 query, predicted);
}

void add_clearance_cost(const LegPlaces& places, const LegOwner& own,
                        std::span<const OtherLeg> others, float clearance_m, SimdTarget target,
                        PlaceNumbers& costs) {
  THRONG_CHOOSE(target, add_clearance_cost_simd, add_clearance_cost_scalar)
  (places, own, others, clearance_m, costs);
}

void add_cadence_cost(const CadenceCandidates& cadences, const std::array<LegState, 2>& own,
                      std::span<const PredictedLegs> others, float clearance_m, SimdTarget target,
                      CadenceNumbers& costs) {
  THRONG_CHOOSE(target, add_cadence_cost_simd, add_cadence_cost_scalar)
  (cadences, own, others, clearance_m, costs);
}

bool find_upper_box(const UpperBodyBounds::Shapes& shapes, std::span<const PartPose> poses,
                    const RoundBounds& all, SimdTarget target, RootBox& box) {
  return THRONG_CHOOSE(target, find_upper_box_simd, find_upper_box_scalar)(shapes, poses, all, box);
}

}  // namespace throng
#endif
