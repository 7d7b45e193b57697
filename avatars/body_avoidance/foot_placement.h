// Footing: how the steps of somebody who walks keep clear of others' legs: in rhythm with those who
// are close ahead, and landing beside their feet.
// One rule: of two feet the one that lands later gives way.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "avatars/body_avoidance/leg_prediction.h"
#include "avatars/body_avoidance/leg_state.h"
#include "base/simd.h"

namespace throng {

/// Where somebody is and goes.
struct RootMotion {
  Eigen::Vector2f root_m, velocity_mps;
};

/// When legs of somebody near could meet one's own: from then on, in so many parts of so long.
struct LegEncounter {
  static constexpr size_t kParts = 10;
  size_t neighbour;
  float from_s, per_s;
  /// The middle of the k-th part.
  float time_s(size_t k) const { return from_s + (static_cast<float>(k) + 0.5f) * per_s; }
};

/// Of the first two that come soon.
struct LegEncounters {
  static constexpr size_t kMax = 2;
  std::array<LegEncounter, kMax> all;
  size_t count = 0;
};

/// None if too many are near: nobody keeps step with all of them.
LegEncounters find_encounters(std::span<const RootMotion> neighbours, const RootMotion& own);

/// How much longer strides than the gait's (and rarer, then) keep legs apart from those of others;
/// 1 if it makes no difference. `others` are those met, one each; `now` is what strides are.
float stride_scale_for(const WalkState& own, std::span<const WalkState> others,
                       const LegEncounters& encounters, float now, SimdTarget target);

/// A foot that comes down, and others' legs on the ground near it meanwhile.
class FootPlacement {
 public:
  /// Keeps a reference to `own`.
  FootPlacement(const WalkState& own, size_t side, SimdTarget target);

  /// Whether the foot lands soon enough for its place to be decided; if not, nothing else is asked.
  bool is_due() const { return is_due_; }
  /// Whether legs of somebody whose root is there and goes so could matter.
  bool may_conflict(const Eigen::Vector2f& root_m, const Eigen::Vector2f& velocity_mps) const;
  void add(const WalkState& other);

  /// How far from where it would the foot has to land (root frame, scale 1).
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
