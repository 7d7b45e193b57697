// Kernels of body avoidance: scalar reference and SIMD loops. Internal to the folder.
// Invariant: all SIMD targets compute the same bits.
#pragma once

#include <cstddef>
#include <span>

#include "avatars/body_avoidance/body_avoidance.h"
#include "avatars/body_avoidance/leg_prediction.h"
#include "avatars/body_avoidance/upper_body_bounds.h"

namespace throng {

AvoidanceMotion target_avoidance_scalar(const BodyState2d& own,
                                        std::span<const BodyState2d* const> neighbours,
                                        std::span<const WallState2d> walls);

void predict_scalar(const LegState& leg, const PlaceNumbers& ahead_s, size_t count,
                    PredictedLeg& predicted);
bool violates_clearance_scalar(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                               const LegOwner& other_owner, float clearance_m, size_t count);
bool predict_clearance_scalar(const LegState& leg, const PlaceNumbers& ahead_s,
                              const LegPlaces& own, const LegQuery& query, LegClearance& predicted);
void add_clearance_cost_scalar(const LegPlaces& places, const LegOwner& own,
                               std::span<const OtherLeg> others, float clearance_m,
                               PlaceNumbers& costs);
void add_cadence_cost_scalar(const CadenceCandidates& cadences, const std::array<LegState, 2>& own,
                             std::span<const PredictedLegs> others, float clearance_m,
                             CadenceNumbers& costs);

inline constexpr size_t kShapeLanes = 8;

/// Computes the box around all shapes; returns false if `all` does not contain it.
bool find_upper_box(const UpperBodyBounds::Shapes& shapes, std::span<const PartPose> poses,
                    const RoundBounds& all, SimdTarget target, RootBox& box);

bool find_upper_box_scalar(const UpperBodyBounds::Shapes& shapes, std::span<const PartPose> poses,
                           const RoundBounds& all, RootBox& box);

}  // namespace throng
