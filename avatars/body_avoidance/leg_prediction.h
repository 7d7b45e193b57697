// Leg prediction samples a leg at several times or landing points and scores its clearance to other
// legs, for foot_placement.
// Invariant: all SIMD targets compute the same bits.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "avatars/body_avoidance/leg_state.h"
#include "base/simd.h"

namespace throng {

inline constexpr size_t kPlaces = 32;
using PlaceNumbers = float[kPlaces];

/// Places of a leg seen from above, in metres, as a structure of arrays.
struct LegPlaces {
  alignas(64) PlaceNumbers foot_x, foot_y, shin_x, shin_y, knee_x, knee_y;

  LegPlace at(size_t i) const {
    return {{foot_x[i], foot_y[i]}, {shin_x[i], shin_y[i]}, {knee_x[i], knee_y[i]}};
  }
};

struct PredictedLeg {
  LegPlaces places;
  /// 1: on the ground, or just lifted; 0: in the air.
  alignas(64) PlaceNumbers is_grounded;
  /// Share of a change of the next landing point that the leg has followed by then.
  alignas(64) PlaceNumbers share;
};

/// Predicts a leg at the first `count` times (or the padding), in the frame of its WalkState.
void predict(const LegState& leg, const PlaceNumbers& ahead_s, size_t count, SimdTarget target,
             PredictedLeg& predicted);

struct LegOwner {
  Eigen::Vector2f ahead;  ///< unit vector along the feet
  float scale;
};

struct OtherLeg {
  LegPlace place;
  LegOwner owner;
};

/// Adds the squared clearance deficits of feet, shins and knees to the cost of each place, in
/// square metres. Deficit: clearance_m less the distance to each other leg.
void add_clearance_cost(const LegPlaces& places, const LegOwner& own,
                        std::span<const OtherLeg> others, float clearance_m, SimdTarget target,
                        PlaceNumbers& costs);

/// Whether legs come nearer than clearance_m at any of the first `count` times (or the padding).
bool violates_clearance(const LegPlaces& leg, const LegOwner& own, const LegPlaces& other,
                        const LegOwner& other_owner, float clearance_m, size_t count,
                        SimdTarget target);

struct LegQuery {
  LegOwner own, other;
  float max_distance_m;  ///< feet farther apart are ignored
  float clearance_m;
};

struct LegClearance {
  LegPlaces places;
  /// 1: within reach and on the ground or just lifted; 0: not relevant.
  alignas(64) PlaceNumbers is_relevant;
  alignas(64) PlaceNumbers cost;
};

inline constexpr size_t kPredictionTimes = 8;
/// Predicts another leg at the first kPredictionTimes times; one's own leg is at `own`. Returns
/// false and sets nothing if the other is never relevant.
bool predict_clearance(const LegState& leg, const PlaceNumbers& ahead_s, const LegPlaces& own,
                       const LegQuery& query, SimdTarget target, LegClearance& predicted);

/// Candidate cadences: cycles per second until lead_s and after it. All are above 0.
inline constexpr size_t kCadences = 16;
using CadenceNumbers = float[kCadences];
struct CadenceCandidates {
  alignas(64) CadenceNumbers soon_ps, later_ps;
  float lead_s;
};

struct PredictedLegs {
  float ahead_s;
  float weight;
  std::array<OtherLeg, 2> legs;
  size_t count;  ///< number of legs
};

/// Adds the weighted costs of the other legs to each cadence, as in add_clearance_cost().
void add_cadence_cost(const CadenceCandidates& cadences, const std::array<LegState, 2>& own,
                      std::span<const PredictedLegs> others, float clearance_m, SimdTarget target,
                      CadenceNumbers& costs);

}  // namespace throng
