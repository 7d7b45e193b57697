// FootPlacement shifts landing points to keep clear of others' legs; stride_scale_for() adapts the
// cadence to walkers close ahead.
// Invariant: of two feet the one that lands later yields.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "avatars/body_avoidance/leg_prediction.h"
#include "avatars/body_avoidance/leg_state.h"
#include "base/simd.h"

namespace throng {

struct RootMotion {
  Eigen::Vector2f root_m, velocity_mps;
};

/// Interval in which legs of a neighbour could meet one's own, in kParts equal parts.
struct LegEncounter {
  static constexpr size_t kParts = 10;
  size_t neighbour;
  float from_s, per_s;
  float time_s(size_t k) const { return from_s + (static_cast<float>(k) + 0.5f) * per_s; }
};

struct LegEncounters {
  static constexpr size_t kMax = 2;
  std::array<LegEncounter, kMax> all;
  size_t count = 0;
};

/// Returns the encounters; none if too many neighbours are near to adapt the cadence to.
LegEncounters find_encounters(std::span<const RootMotion> neighbours, const RootMotion& own);

/// Returns the stride scale that keeps legs apart; 1 if it makes no difference. `others`: one per
/// encounter; `now`: the current stride scale.
float stride_scale_for(const WalkState& own, std::span<const WalkState> others,
                       const LegEncounters& encounters, float now, SimdTarget target);

/// A landing foot, and others' legs on the ground near it at that time.
class FootPlacement {
 public:
  /// Keeps a reference to `own`.
  FootPlacement(const WalkState& own, size_t side, SimdTarget target);

  /// Whether the foot lands soon enough to choose its place. If not, no other member may be called.
  bool is_due() const { return is_due_; }
  /// Whether legs of a person with this root position and velocity could matter.
  bool may_conflict(const Eigen::Vector2f& root_m, const Eigen::Vector2f& velocity_mps) const;
  void add(const WalkState& other);

  /// Returns the shift of the landing point (root frame, scale 1).
  Eigen::Vector2f shift_m() const;

 private:
  static constexpr size_t kSamples = 7, kMaxLegs = 12;

  alignas(64) PlaceNumbers ahead_s_;
  PredictedLeg leg_;
  std::array<std::array<OtherLeg, kMaxLegs>, kSamples> legs_;
  std::array<size_t, kSamples> counts_{};
  const WalkState& own_;
  size_t side_;
  SimdTarget target_;
  bool is_due_ = false;
  bool is_free_ = true;
};

}  // namespace throng
