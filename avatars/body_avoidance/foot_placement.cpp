#include "avatars/body_avoidance/foot_placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace throng {
namespace {

using Eigen::Vector2f;

constexpr float kClearance_m = 0.09f;
// Increment for shortening a step, and the largest sideways shift.
constexpr float kStep_m = 0.05f;
constexpr int kMinShiftSteps = -5;  // in steps of kStep_m; steps are never lengthened
constexpr float kMaxAside_m = 0.17f,
                kInwardShare = 0.9f;  // of the foot's distance from the middle
constexpr float kEffort = 0.003f;
// Cycles before the landing at which legs are compared.
constexpr std::array<float, 7> kSamplePhases = {0.3f, 0.22f, 0.15f, 0.07f, 0, -0.07f, -0.14f};
constexpr size_t kLandingSample = 4;
static_assert(kSamplePhases[kLandingSample] == 0);
// People whose root, and legs whose foot, is farther than this cannot interfere.
constexpr float kMaxRootDistance_m = 0.95f;
constexpr float kMaxLegDistance_m = 0.6f;
// A foot may change its landing point from this long before it lands.
constexpr float kWindow_s = 0.5f;
// Cadence is chosen this far ahead, for people within kCadenceReach_m, while legs can meet.
constexpr float kCadenceHorizon_s = 2.4f, kCadenceReach_m = 0.8f, kLegsReach_m = 1.0f;
// Feet of others within this distance ahead of, behind or next to the root can obstruct one's own.
constexpr float kObstructionAhead_m = 0.9f, kObstructionAside_m = 0.55f;
// Paths and cadences are predicted less exactly, hence a larger clearance in this choice.
constexpr float kCadenceClearance_m = 0.22f;
// Strides change until legs can meet, at least for this long; then the cadence is kept.
constexpr float kMinLead_s = 0.5f;
constexpr float kStrideScaleStep = 0.07f;
constexpr int kMinStrideSteps = -4, kMaxStrideSteps = 2;
constexpr size_t kStrideScales = kMaxStrideSteps - kMinStrideSteps + 1;
// Highest cadence for shortened strides, unless the gait's own is higher: else the pelvis jerks.
constexpr float kMaxChosenCadence_hz = 1.45f;
// Cost of 1 s with legs 1 m too near, squared, relative to the squared change of stride.
constexpr float kClearanceWeight = 300, kCadenceEffort = 0.3f, kCadenceChange = 0.2f;
// With more people than this within kAround_m, cadence is not adapted.
constexpr int kMaxPeopleAround = 3;
constexpr float kAround_m = 1.1f;
// Later encounters are left to a later choice.
constexpr float kMaxEncounterTime_s = 1.2f;
// Below this speed there is no cadence to choose.
constexpr float kMinWalkingSpeed_mps = 0.3f;

Vector2f left_of(const Vector2f& v) { return {-v.y(), v.x()}; }

LegOwner owner_of(const WalkState& steps) { return {steps.ahead, steps.scale}; }

/// Returns whether two roots come within reach, and sets when.
bool find_encounter(const RootMotion& own, const RootMotion& other, LegEncounter& encounter) {
  const Vector2f offset = other.root_m - own.root_m,
                 closing = other.velocity_mps - own.velocity_mps;
  const float speed2 = std::max(closing.squaredNorm(), 1e-4f);
  const float middle_s = -offset.dot(closing) / speed2;
  const float nearest_s = std::clamp(middle_s, 0.0f, kCadenceHorizon_s);
  if ((offset + nearest_s * closing).squaredNorm() > kCadenceReach_m * kCadenceReach_m)
    return false;
  const float min_distance2 = (offset + middle_s * closing).squaredNorm();
  const float half_s =
      std::sqrt(std::max(kLegsReach_m * kLegsReach_m - min_distance2, 0.0f) / speed2);
  encounter.from_s = std::clamp(middle_s - half_s, 0.0f, kCadenceHorizon_s);
  encounter.per_s = (std::clamp(middle_s + half_s, 0.0f, kCadenceHorizon_s) - encounter.from_s) /
                    LegEncounter::kParts;
  return true;
}

class CadenceChoice {
 public:
  CadenceChoice(const WalkState& own, std::span<const WalkState> others,
                const LegEncounters& encounters, float now)
      : legs_{LegState(own, 0), LegState(own, 1)},
        encounters_(encounters),
        now_(now),
        natural_ps_(own.velocity_mps.dot(own.ahead) / (own.track.stride_m * own.scale)) {
    for (size_t i = 0; i < encounters.count; ++i) others_[i] = others[i].in_frame_of(own);
  }

  float best(SimdTarget target) {
    bool is_free = true;  // true: no stride scale is better than 1
    for (size_t i = 0; i < encounters_.count; ++i) {
      Prediction& predicted = predicted_[i];
      // Padding: repeats the last time.
      for (size_t k = 0; k < kPlaces; ++k)
        predicted.ahead_s[k] = encounters_.all[i].time_s(std::min(k, kTimes - 1));
      for (size_t side = 0; side < 2; ++side)
        predict(LegState(others_[i], side), predicted.ahead_s, kTimes, target,
                predicted.legs[side]);
      is_free = is_free && !has_conflict(i, target);
    }
    return is_free ? 1 : best_of_cadences(target);
  }

 private:
  static constexpr size_t kTimes = LegEncounter::kParts;
  struct Prediction {
    alignas(64) PlaceNumbers ahead_s;
    std::array<PredictedLeg, 2> legs;
  };

  /// Returns whether legs conflict at an encounter if strides keep the gait's length.
  bool has_conflict(size_t encounter, SimdTarget target) const {
    const Prediction& predicted = predicted_[encounter];
    for (LegState leg : legs_) {
      leg.cadence_hz = natural_ps_;
      leg.root_m = Vector2f::Zero();
      leg.ahead_m = Vector2f::UnitX();
      PredictedLeg own;
      predict(leg, predicted.ahead_s, kTimes, target, own);
      for (const PredictedLeg& other : predicted.legs)
        if (violates_clearance(own.places, {Vector2f::UnitX(), 1}, other.places,
                               owner_of(others_[encounter]), kCadenceClearance_m, kTimes, target))
          return true;
    }
    return false;
  }

  float best_of_cadences(SimdTarget target) {
    cadences_.lead_s = kCadenceHorizon_s;
    for (size_t i = 0; i < encounters_.count; ++i) {
      cadences_.lead_s = std::min(cadences_.lead_s, encounters_.all[i].from_s);
      add_times(i);
    }
    cadences_.lead_s = std::max(cadences_.lead_s, kMinLead_s);
    if (count_ == 0) return 1;
    std::array<float, kCadences> stride_scales;
    set_cadences(stride_scales);
    add_cadence_cost(cadences_, legs_, {times_.data(), count_}, kCadenceClearance_m, target,
                     costs_);
    const float* cheapest = std::min_element(costs_, costs_ + kCadences);
    return stride_scales[static_cast<size_t>(cheapest - costs_)];
  }

  void add_times(size_t encounter) {
    const Prediction& predicted = predicted_[encounter];
    for (size_t k = 0; k < kTimes; ++k) {
      PredictedLegs& future = times_[count_];
      future.ahead_s = predicted.ahead_s[k];
      future.weight = kClearanceWeight * encounters_.all[encounter].per_s;
      future.count = 0;
      for (const PredictedLeg& leg : predicted.legs) {
        const LegPlace place = leg.places.at(k);
        const Vector2f from_root = place.foot_m - future.ahead_s * legs_[0].velocity_mps;
        if (std::abs(from_root.x()) < kObstructionAhead_m &&
            std::abs(from_root.y()) < kObstructionAside_m)
          future.legs[future.count++] = {place, owner_of(others_[encounter])};
      }
      count_ += future.count > 0;
    }
  }

  /// Sets all stride scales, each followed either by the gait's own stride or by itself.
  void set_cadences(std::array<float, kCadences>& stride_scales) {
    static_assert(2 * kStrideScales <= kCadences);
    const float min_stride_scale = natural_ps_ / std::max(kMaxChosenCadence_hz, natural_ps_);
    for (size_t i = 0; i < kCadences; ++i) {
      const size_t step = std::min(i / 2, kStrideScales - 1);  // the last ones repeat
      const float stride_scale = std::max(
          1 + kStrideScaleStep * static_cast<float>(kMinStrideSteps + static_cast<int>(step)),
          min_stride_scale);
      const float later = i % 2 == 0 ? 1 : stride_scale;
      stride_scales[i] = stride_scale;
      cadences_.soon_ps[i] = natural_ps_ / stride_scale;
      cadences_.later_ps[i] = natural_ps_ / later;
      const auto square = [](float x) { return x * x; };
      costs_[i] = kCadenceEffort * (square(stride_scale - 1) + square(later - 1)) +
                  kCadenceChange * square(stride_scale - now_);
    }
  }

  std::array<Prediction, LegEncounters::kMax> predicted_;
  alignas(64) CadenceNumbers costs_;
  CadenceCandidates cadences_;
  std::array<LegState, 2> legs_;
  const LegEncounters& encounters_;
  float now_;
  float natural_ps_;  ///< cadence at the gait's own stride
  std::array<WalkState, LegEncounters::kMax> others_;
  std::array<PredictedLegs, LegEncounters::kMax * kTimes> times_;
  size_t count_ = 0;  ///< number of entries in times_
};

/// Candidate shifts of the next landing, root frame at scale 1.
struct LandingShifts {
  alignas(64) PlaceNumbers along = {}, aside = {};
  size_t count = 1;  ///< the first shift is zero, and so is the padding

  explicit LandingShifts(const FootTrack& track, size_t side) {
    // Shifts inwards end before the other foot: feet do not cross.
    const float inwards = kInwardShare * std::abs(track.side_m[side]);
    const float right = side == 0 ? -kMaxAside_m : -inwards,
                left = side == 0 ? inwards : kMaxAside_m;
    for (int i = kMinShiftSteps; i <= 0; ++i)
      for (const float y : {0.0f, 0.5f * right, right, 0.5f * left, left}) {
        along[count] = kStep_m * static_cast<float>(i);
        aside[count++] = y;
      }
  }
};
static_assert((1 - kMinShiftSteps) * 5 + 1 <= kPlaces);

LegPlaces shifted_places(const PredictedLeg& leg, size_t time, const WalkState& own,
                         const LandingShifts& shifts) {
  const LegPlace place = leg.places.at(time);
  const Vector2f ahead = own.scale * leg.share[time] * own.ahead, left = left_of(ahead);
  LegPlaces places;
  for (size_t i = 0; i < kPlaces; ++i) {
    const float x = shifts.along[i] * ahead.x() + shifts.aside[i] * left.x();
    const float y = shifts.along[i] * ahead.y() + shifts.aside[i] * left.y();
    places.foot_x[i] = place.foot_m.x() + x, places.foot_y[i] = place.foot_m.y() + y;
    places.shin_x[i] = place.shin_m.x() + 0.75f * x,
    places.shin_y[i] = place.shin_m.y() + 0.75f * y;
    places.knee_x[i] = place.knee_m.x() + 0.5f * x, places.knee_y[i] = place.knee_m.y() + 0.5f * y;
  }
  return places;
}

}  // namespace

LegEncounters find_encounters(std::span<const RootMotion> neighbours, const RootMotion& own) {
  LegEncounters found;
  const auto around =
      std::count_if(neighbours.begin(), neighbours.end(), [&own](const RootMotion& other) {
        return (other.root_m - own.root_m).squaredNorm() < kAround_m * kAround_m;
      });
  if (around > kMaxPeopleAround) return found;
  for (size_t i = 0; i < neighbours.size() && found.count < LegEncounters::kMax; ++i) {
    LegEncounter& encounter = found.all[found.count];
    if (!find_encounter(own, neighbours[i], encounter) || encounter.from_s > kMaxEncounterTime_s)
      continue;
    encounter.neighbour = i;
    ++found.count;
  }
  return found;
}

float stride_scale_for(const WalkState& own, std::span<const WalkState> others,
                       const LegEncounters& encounters, float now, SimdTarget target) {
  if (own.cadence_hz < kMinCadence_hz || own.velocity_mps.dot(own.ahead) < kMinWalkingSpeed_mps)
    return 1;
  return CadenceChoice(own, others, encounters, now).best(target);
}

FootPlacement::FootPlacement(const WalkState& own, size_t side, SimdTarget target)
    : own_(own), side_(side), target_(target) {
  static_assert(kSamplePhases.size() == kSamples && kSamples <= kPredictionTimes);
  LegState leg(own, side);
  leg.landing_m = Vector2f::Zero();  // relative to the landing point of the gait
  const float lands_s = leg.lands_s();
  is_due_ = lands_s >= 0 && lands_s <= kWindow_s;
  if (!is_due_) return;
  for (size_t i = 0; i < kPlaces; ++i) {
    const float before = kSamplePhases[std::min(i, kSamples - 1)];
    ahead_s_[i] = std::max(lands_s - before / own.cadence_hz, 0.0f);
  }
  predict(leg, ahead_s_, kPredictionTimes, target, leg_);
}

bool FootPlacement::may_conflict(const Vector2f& root_m, const Vector2f& velocity_mps) const {
  const Vector2f future = root_m + ahead_s_[kLandingSample] * velocity_mps;
  return (future - leg_.places.at(kLandingSample).foot_m).squaredNorm() <=
         kMaxRootDistance_m * kMaxRootDistance_m;
}

void FootPlacement::add(const WalkState& other) {
  const LegQuery query = {owner_of(own_), owner_of(other), kMaxLegDistance_m, kClearance_m};
  LegClearance clearance;
  for (size_t side = 0; side < 2; ++side) {
    if (!predict_clearance(LegState(other, side), ahead_s_, leg_.places, query, target_, clearance))
      continue;
    for (size_t time = 0; time < kSamples; ++time) {
      if (clearance.is_relevant[time] == 0 || counts_[time] == kMaxLegs) continue;
      legs_[time][counts_[time]++] = {clearance.places.at(time), query.other};
      is_free_ = is_free_ && clearance.cost[time] == 0;
    }
  }
}

Vector2f FootPlacement::shift_m() const {
  if (is_free_) return Vector2f::Zero();
  const LandingShifts shifts(own_.track, side_);
  alignas(64) PlaceNumbers costs = {};
  for (size_t time = 0; time < kSamples; ++time)
    if (counts_[time] > 0)
      add_clearance_cost(shifted_places(leg_, time, own_, shifts), owner_of(own_),
                         {legs_[time].data(), counts_[time]}, kClearance_m, target_, costs);
  size_t best = 0;
  for (size_t i = 0; i < shifts.count; ++i) {
    const float along = shifts.along[i], aside = shifts.aside[i];
    costs[i] += kEffort * (along * along + 2 * aside * aside);
    if (costs[i] < costs[best]) best = i;
  }
  return {shifts.along[best], shifts.aside[best]};
}

}  // namespace throng
