// One leg at many times, or at many places where it could be, and how near it comes there to those
// of others: what footing chooses by.
// One rule: every SIMD target gives the same bits.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "avatars/body_avoidance/leg_state.h"
#include "base/simd.h"

namespace throng {

/// A number for each of the places that are compared at once.
inline constexpr size_t kPlaces = 32;
using PlaceNumbers = float[kPlaces];

/// Places of a leg, seen from above, in metres: structure of arrays.
struct LegPlaces {
  alignas(64) PlaceNumbers foot_x, foot_y, shin_x, shin_y, knee_x, knee_y;

  LegPlace at(size_t i) const {
    return {{foot_x[i], foot_y[i]}, {shin_x[i], shin_y[i]}, {knee_x[i], knee_y[i]}};
  }
};

/// Where a leg will be.
struct PredictedLeg {
  LegPlaces places;
  /// 1: on the ground, or has hardly left it; 0: in the air.
  alignas(64) PlaceNumbers is_grounded;
  /// Of a change to where it lands next: the share that it has followed by then.
  alignas(64) PlaceNumbers share;
};

/// At the first `count` of the times, and any beyond, as the WalkState of the leg have places.
void predict(const LegState& leg, const PlaceNumbers& ahead_s, size_t count, SimdTarget target,
             PredictedLeg& predicted);

/// Whose a leg is, as far as that matters here.
struct LegOwner {
  Eigen::Vector2f ahead;  ///< unit: the way its feet point
  float scale;
};

/// A leg of somebody else.
struct OtherLeg {
  LegPlace place;
  LegOwner owner;
};

/// Adds to the cost of each place the squares of what feet, shins and knees lack to be `clear_m`
/// apart from each of the others, square metres.
void add_clearance_cost(const LegPlaces& places, const LegOwner& own,
                        std::span<const OtherLeg> others, float clearance_m, SimdTarget target,
                        PlaceNumbers& costs);

/// Whether two legs come nearer than `clear_m`, as add_clearance_cost() has it, at any of the first
/// `count` of some times, or of any beyond up to a register.
bool violates_clearance(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                        const LegOwner& other_owner, float clearance_m, size_t count,
                        SimdTarget target);

/// What of somebody else's leg matters to one's own.
struct LegQuery {
  LegOwner own, other;
  float max_distance_m;  ///< feet that are farther apart do not matter
  float clearance_m;
};

/// Where somebody else's leg will be.
struct LegClearance {
  LegPlaces places;
  /// 1: it matters, and is on the ground or has hardly left it; 0: not.
  alignas(64) PlaceNumbers is_relevant;
  /// What adds to a cost, see add_clearance_cost(), of those that matter.
  alignas(64) PlaceNumbers cost;
};

inline constexpr size_t kPredictionTimes = 8;
/// At the first eight of the times, where one's own leg will be as `own` says. False: it never
/// matters; nothing is set then.
bool predict_clearance(const LegState& leg, const PlaceNumbers& ahead_s, const LegPlaces& own,
                       const LegQuery& query, SimdTarget target, LegClearance& predicted);

/// Rhythms that somebody could walk in: cycles a second until some time, and from then on. All
/// above 0.
inline constexpr size_t kCadences = 16;
using CadenceNumbers = float[kCadences];
struct CadenceCandidates {
  alignas(64) CadenceNumbers soon_ps, later_ps;
  float lead_s;
};

/// Legs of somebody else at some time, in the frame of LegState.
struct PredictedLegs {
  float ahead_s;
  float weight;
  std::array<OtherLeg, 2> legs;
  size_t count;  ///< of the legs
};

/// Adds to the cost of each rhythm how near one's own legs come to those of others, as
/// add_clearance_cost() has it, times the weights.
void add_cadence_cost(const CadenceCandidates& cadences, const std::array<LegState, 2>& own,
                      std::span<const PredictedLegs> others, float clearance_m, SimdTarget target,
                      CadenceNumbers& costs);

}  // namespace throng
