// Footing: how the steps of somebody who walks keep clear of others' legs: in rhythm with those who
// are close ahead, and landing beside their feet.
// One rule: of two feet the one that lands later gives way.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "avatars/yielding/footfall.h"
#include "avatars/yielding/many_legs.h"
#include "base/simd.h"

namespace throng {

/// Where somebody is and goes.
struct Course {
  Eigen::Vector2f root_m, velocity_mps;
};

/// When legs of somebody near could meet one's own: from then on, in so many parts of so long.
struct Meeting {
  static constexpr size_t kParts = 10;
  size_t who;
  float from_s, per_s;
  /// The middle of the k-th part.
  float time_s(size_t k) const { return from_s + (static_cast<float>(k) + 0.5f) * per_s; }
};

/// Of the first two that come soon.
struct Meetings {
  static constexpr size_t kMost = 2;
  std::array<Meeting, kMost> all;
  size_t count = 0;
};

/// None if too many are near: nobody keeps step with all of them.
Meetings meetings_with(std::span<const Course> near, const Course& own);

/// How much longer strides than the gait's (and rarer, then) keep legs apart from those of others;
/// 1 if it makes no difference. `others` are those met, one each; `now` is what strides are.
float stretch_for(const Steps& own, std::span<const Steps> others, const Meetings& meetings,
                  float now, SimdTarget target);

/// A foot that comes down, and others' legs on the ground near it meanwhile.
class Landing {
 public:
  /// Keeps a reference to `own`.
  Landing(const Steps& own, size_t side, SimdTarget target);

  /// Whether the foot lands soon enough for its place to be decided; if not, nothing else is asked.
  bool is_due() const { return is_due_; }
  /// Whether legs of somebody whose root is there and goes so could matter.
  bool may_meet(const Eigen::Vector2f& root_m, const Eigen::Vector2f& velocity_mps) const;
  void add(const Steps& other);

  /// How far from where it would the foot has to land (root frame, scale 1).
  Eigen::Vector2f shift_m() const;

 private:
  static constexpr size_t kMoments = 7, kMostLegs = 12;

  alignas(64) PlaceNumbers ahead_s_;
  ForeseenLeg leg_;
  std::array<std::array<OtherLeg, kMostLegs>, kMoments> legs_;
  std::array<size_t, kMoments> counts_{};
  const Steps& own_;
  size_t side_;
  SimdTarget target_;
  bool is_due_ = false;
  bool is_free_ = true;
};

}  // namespace throng
