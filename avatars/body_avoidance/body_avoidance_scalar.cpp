#include <algorithm>
#include <array>
#include <cmath>

#include "avatars/body_avoidance/body_avoidance_kernels.h"
#include "avatars/gait/gait_curves.h"
#include "base/portable_math.h"
#include "base/simd/scalar_lanes.h"

namespace throng {
namespace scalar_lanes {
namespace {

#include "base/simd/angles-inl.h"
//
#include "avatars/body_avoidance/clearance_constraints-inl.h"

}  // namespace
}  // namespace scalar_lanes

float ArmTuck::share_of(float swing_damping) { return scalar_lanes::share_of(swing_damping).v; }

AvoidanceMotion target_avoidance_scalar(const BodyState2d& own,
                                        std::span<const BodyState2d* const> neighbours,
                                        std::span<const WallState2d> walls) {
  return scalar_lanes::compute_target(own, neighbours, walls);
}

namespace scalar_lanes {
namespace {

#include "avatars/body_avoidance/leg_prediction-inl.h"

}  // namespace
}  // namespace scalar_lanes

void predict_scalar(const LegState& leg, const PlaceNumbers& ahead_s, size_t count,
                    PredictedLeg& predicted) {
  for (size_t i = 0; i < count; ++i) scalar_lanes::predict_at(i, leg, ahead_s, predicted);
}

bool violates_clearance_scalar(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                               const LegOwner& other_owner, float clearance_m, size_t count) {
  for (size_t i = 0; i < count; ++i)
    if (scalar_lanes::violates_clearance_at(i, leg, own, other, other_owner, clearance_m))
      return true;
  return false;
}

bool predict_clearance_scalar(const LegState& leg, const PlaceNumbers& ahead_s,
                              const LegPlaces& own, const LegQuery& query,
                              LegClearance& predicted) {
  bool is_relevant = false;
  for (size_t i = 0; i < kPredictionTimes; ++i) {
    predicted.is_relevant[i] = 0;
    is_relevant |= scalar_lanes::predict_clearance_at(i, leg, ahead_s, own, query, predicted);
  }
  return is_relevant;
}

void add_clearance_cost_scalar(const LegPlaces& places, const LegOwner& own,
                               std::span<const OtherLeg> others, float clearance_m,
                               PlaceNumbers& costs) {
  for (size_t i = 0; i < kPlaces; ++i)
    scalar_lanes::add_clearance_cost_at(i, places, own, others, clearance_m, costs);
}

void add_cadence_cost_scalar(const CadenceCandidates& cadences, const std::array<LegState, 2>& own,
                             std::span<const PredictedLegs> others, float clearance_m,
                             CadenceNumbers& costs) {
  for (size_t i = 0; i < kCadences; ++i)
    scalar_lanes::add_cadence_cost_at(i, cadences, own, others, clearance_m, costs);
}

namespace scalar_lanes {
namespace {

#include "avatars/body_avoidance/upper_body_bounds-inl.h"

}  // namespace
}  // namespace scalar_lanes

bool find_upper_box_scalar(const UpperBodyBounds::Shapes& shapes, std::span<const PartPose> poses,
                           const RoundBounds& all, RootBox& box) {
  return scalar_lanes::upper_box(shapes, poses, all, box);
}

}  // namespace throng
