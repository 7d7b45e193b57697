#include "avatars/yielding/footing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace throng {
namespace {

using Eigen::Vector2f;

// Feet stay so far apart, and shins.
constexpr float kClear_m = 0.09f;
// A step is shortened by so much at a time, and moved to the side by so much at most.
constexpr float kStep_m = 0.05f;
constexpr int kShortest = -5;  // of them; never longer
constexpr float kMostAside_m = 0.17f,
                kInwards = 0.9f;  // the latter of the foot's distance from the middle
constexpr float kEffort = 0.003f;
// Shares of the cycle before a foot lands; others' legs that are farther off then do not matter.
constexpr std::array<float, 7> kMomentsBefore = {0.3f, 0.22f, 0.15f, 0.07f, 0, -0.07f, -0.14f};
constexpr size_t kLanding = 4;
static_assert(kMomentsBefore[kLanding] == 0);
// Of somebody so far from where the foot lands no leg is in its way.
constexpr float kFar_m = 0.95f;
constexpr float kFarOff_m = 0.6f;
// A foot gets a new place from so long before it lands.
constexpr float kWindow_s = 0.5f;
// The rhythm of steps is chosen so far ahead, for those whose roots come so near, and by the time
// in which legs can meet.
constexpr float kRhythmAhead_s = 2.4f, kRhythmReach_m = 0.8f, kLegsReach_m = 1.0f;
// So far ahead of the own root, or behind, and to a side of it feet can be in the way of one's own.
constexpr float kInTheWayAhead_m = 0.9f, kInTheWayAside_m = 0.55f;
// Ways and rhythms are not foreseen so exactly: legs get more room in the choice.
constexpr float kRhythmClear_m = 0.22f;
// Until legs can meet, and for so long at least, steps are shortened or lengthened to get in time;
// then a rhythm is kept.
constexpr float kLeastLead_s = 0.5f;
// Strides are from so much shorter to so much longer than the gait's, in steps of so much.
constexpr float kStretchStep = 0.07f;
constexpr int kShortestStrides = -4, kLongestStrides = 2;
constexpr size_t kStretches = kLongestStrides - kShortestStrides + 1;
// Shorter strides are no quicker than this, unless the gait's own are: a pelvis that goes up and
// down as for long ones would jerk.
constexpr float kQuickestSteps_hz = 1.45f;
// What a second with legs too near by a metre weighs, squared, against a stride of another length
// squared.
constexpr float kNearness = 300, kRhythmEffort = 0.3f, kRhythmChange = 0.2f;
// Among more than so many people, so near, nobody keeps step with all of them.
constexpr int kMostAround = 3;
constexpr float kAround_m = 1.1f;
// What meets later than this is left to a later choice.
constexpr float kSoonEnough_s = 1.2f;
// Whoever hardly walks has no rhythm.
constexpr float kSlowest_mps = 0.3f;

Vector2f left_of(const Vector2f& v) { return {-v.y(), v.x()}; }

LegOwner owner_of(const Steps& steps) { return {steps.ahead, steps.scale}; }

/// Whether they come near, and then when.
bool find_meeting(const Course& own, const Course& other, Meeting& meeting) {
  const Vector2f way = other.root_m - own.root_m, closing = other.velocity_mps - own.velocity_mps;
  const float speed2 = std::max(closing.squaredNorm(), 1e-4f);
  const float middle_s = -way.dot(closing) / speed2;
  const float nearest_s = std::clamp(middle_s, 0.0f, kRhythmAhead_s);
  if ((way + nearest_s * closing).squaredNorm() > kRhythmReach_m * kRhythmReach_m) return false;
  const float least2 = (way + middle_s * closing).squaredNorm();
  const float half_s = std::sqrt(std::max(kLegsReach_m * kLegsReach_m - least2, 0.0f) / speed2);
  meeting.from_s = std::clamp(middle_s - half_s, 0.0f, kRhythmAhead_s);
  meeting.per_s =
      (std::clamp(middle_s + half_s, 0.0f, kRhythmAhead_s) - meeting.from_s) / Meeting::kParts;
  return true;
}

class RhythmChoice {
 public:
  RhythmChoice(const Steps& own, std::span<const Steps> others, const Meetings& meetings, float now)
      : legs_{LegNow(own, 0), LegNow(own, 1)},
        meetings_(meetings),
        now_(now),
        natural_ps_(own.velocity_mps.dot(own.ahead) / (own.track.stride_m * own.scale)) {
    for (size_t i = 0; i < meetings.count; ++i) others_[i] = others[i].seen_by(own);
  }

  float best(SimdTarget target) {
    bool is_free = true;  // then nothing is better than the gait's own strides
    for (size_t i = 0; i < meetings_.count; ++i) {
      Foreseen& foreseen = foreseen_[i];
      // Times beyond the last part are its own.
      for (size_t k = 0; k < kPlaces; ++k)
        foreseen.ahead_s[k] = meetings_.all[i].time_s(std::min(k, kTimes - 1));
      for (size_t side = 0; side < 2; ++side)
        foresee(LegNow(others_[i], side), foreseen.ahead_s, kTimes, target, foreseen.legs[side]);
      is_free = is_free && !meets(i, target);
    }
    return is_free ? 1 : best_of_rhythms(target);
  }

 private:
  static constexpr size_t kTimes = Meeting::kParts;
  struct Foreseen {
    alignas(64) PlaceNumbers ahead_s;
    std::array<ForeseenLeg, 2> legs;
  };

  /// Whether legs come too near to those of whom one meets with the gait's own strides.
  bool meets(size_t meeting, SimdTarget target) const {
    const Foreseen& theirs = foreseen_[meeting];
    for (LegNow leg : legs_) {
      leg.cycles_ps = natural_ps_;
      leg.root_m = Vector2f::Zero();
      leg.ahead_m = Vector2f::UnitX();
      ForeseenLeg own;
      foresee(leg, theirs.ahead_s, kTimes, target, own);
      for (const ForeseenLeg& other : theirs.legs)
        if (comes_near(own.places, {Vector2f::UnitX(), 1}, other.places, owner_of(others_[meeting]),
                       kRhythmClear_m, kTimes, target))
          return true;
    }
    return false;
  }

  float best_of_rhythms(SimdTarget target) {
    rhythms_.lead_s = kRhythmAhead_s;
    for (size_t i = 0; i < meetings_.count; ++i) {
      rhythms_.lead_s = std::min(rhythms_.lead_s, meetings_.all[i].from_s);
      add_times(i);
    }
    rhythms_.lead_s = std::max(rhythms_.lead_s, kLeastLead_s);
    if (count_ == 0) return 1;
    std::array<float, kRhythms> stretches;
    set_rhythms(stretches);
    add_nearness_in(rhythms_, legs_, {times_.data(), count_}, kRhythmClear_m, target, costs_);
    const float* least = std::min_element(costs_, costs_ + kRhythms);
    return stretches[static_cast<size_t>(least - costs_)];
  }

  void add_times(size_t meeting) {
    const Foreseen& theirs = foreseen_[meeting];
    for (size_t k = 0; k < kTimes; ++k) {
      LegsThen& then = times_[count_];
      then.ahead_s = theirs.ahead_s[k];
      then.weight = kNearness * meetings_.all[meeting].per_s;
      then.count = 0;
      for (const ForeseenLeg& leg : theirs.legs) {
        const LegPlace place = leg.places.at(k);
        const Vector2f from_root = place.foot_m - then.ahead_s * legs_[0].velocity_mps;
        if (std::abs(from_root.x()) < kInTheWayAhead_m &&
            std::abs(from_root.y()) < kInTheWayAside_m)
          then.legs[then.count++] = {place, owner_of(others_[meeting])};
      }
      count_ += then.count > 0;
    }
  }

  /// Every stretch, and after it the gait's own or the same on and on.
  void set_rhythms(std::array<float, kRhythms>& stretches) {
    static_assert(2 * kStretches <= kRhythms);
    const float shortest = natural_ps_ / std::max(kQuickestSteps_hz, natural_ps_);
    for (size_t i = 0; i < kRhythms; ++i) {
      const size_t step = std::min(i / 2, kStretches - 1);  // the last ones again
      const float stretch =
          std::max(1 + kStretchStep * static_cast<float>(kShortestStrides + static_cast<int>(step)),
                   shortest);
      const float later = i % 2 == 0 ? 1 : stretch;
      stretches[i] = stretch;
      rhythms_.soon_ps[i] = natural_ps_ / stretch;
      rhythms_.later_ps[i] = natural_ps_ / later;
      const auto square = [](float x) { return x * x; };
      costs_[i] = kRhythmEffort * (square(stretch - 1) + square(later - 1)) +
                  kRhythmChange * square(stretch - now_);
    }
  }

  std::array<Foreseen, Meetings::kMost> foreseen_;
  alignas(64) RhythmNumbers costs_;
  Rhythms rhythms_;
  std::array<LegNow, 2> legs_;
  const Meetings& meetings_;
  float now_;
  float natural_ps_;  ///< with the gait's own strides
  std::array<Steps, Meetings::kMost> others_;
  std::array<LegsThen, Meetings::kMost * kTimes> times_;
  size_t count_ = 0;  ///< of times_
};

/// How far the next landing could be moved: along and to the side, root frame at scale 1.
struct LandingShifts {
  alignas(64) PlaceNumbers along = {}, aside = {};
  size_t count = 1;  ///< the first is none, and so are those beyond

  explicit LandingShifts(const FootTrack& track, size_t side) {
    // Feet do not cross.
    const float inwards = kInwards * std::abs(track.side_m[side]);
    const float right = side == 0 ? -kMostAside_m : -inwards,
                left = side == 0 ? inwards : kMostAside_m;
    for (int i = kShortest; i <= 0; ++i)
      for (const float y : {0.0f, 0.5f * right, right, 0.5f * left, left}) {
        along[count] = kStep_m * static_cast<float>(i);
        aside[count++] = y;
      }
  }
};
static_assert((1 - kShortest) * 5 + 1 <= kPlaces);

/// Where a leg is at some time if its next landing is moved.
LegPlaces moved_places(const ForeseenLeg& leg, size_t time, const Steps& own,
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

Meetings meetings_with(std::span<const Course> near, const Course& own) {
  Meetings found;
  const auto around = std::count_if(near.begin(), near.end(), [&own](const Course& other) {
    return (other.root_m - own.root_m).squaredNorm() < kAround_m * kAround_m;
  });
  if (around > kMostAround) return found;
  for (size_t i = 0; i < near.size() && found.count < Meetings::kMost; ++i) {
    Meeting& meeting = found.all[found.count];
    if (!find_meeting(own, near[i], meeting) || meeting.from_s > kSoonEnough_s) continue;
    meeting.who = i;
    ++found.count;
  }
  return found;
}

float stretch_for(const Steps& own, std::span<const Steps> others, const Meetings& meetings,
                  float now, SimdTarget target) {
  if (own.cycles_ps < kSlowestSteps_hz || own.velocity_mps.dot(own.ahead) < kSlowest_mps) return 1;
  return RhythmChoice(own, others, meetings, now).best(target);
}

Landing::Landing(const Steps& own, size_t side, SimdTarget target)
    : own_(own), side_(side), target_(target) {
  static_assert(kMomentsBefore.size() == kMoments && kMoments <= kEightTimes);
  LegNow leg(own, side);
  leg.landing_m = Vector2f::Zero();  // of where it would land
  const float lands_s = leg.lands_s();
  is_due_ = lands_s >= 0 && lands_s <= kWindow_s;
  if (!is_due_) return;
  for (size_t i = 0; i < kPlaces; ++i) {
    const float before = kMomentsBefore[std::min(i, kMoments - 1)];
    ahead_s_[i] = std::max(lands_s - before / own.cycles_ps, 0.0f);
  }
  foresee(leg, ahead_s_, kEightTimes, target, leg_);
}

bool Landing::may_meet(const Vector2f& root_m, const Vector2f& velocity_mps) const {
  const Vector2f then = root_m + ahead_s_[kLanding] * velocity_mps;
  return (then - leg_.places.at(kLanding).foot_m).squaredNorm() <= kFar_m * kFar_m;
}

void Landing::add(const Steps& other) {
  const WhatIsNear near = {owner_of(own_), owner_of(other), kFarOff_m, kClear_m};
  NearLeg there;
  for (size_t side = 0; side < 2; ++side) {
    if (!foresee_near(LegNow(other, side), ahead_s_, leg_.places, near, target_, there)) continue;
    for (size_t time = 0; time < kMoments; ++time) {
      if (there.is_near[time] == 0 || counts_[time] == kMostLegs) continue;
      legs_[time][counts_[time]++] = {there.places.at(time), near.other};
      is_free_ = is_free_ && there.nearness[time] == 0;
    }
  }
}

Vector2f Landing::shift_m() const {
  if (is_free_) return Vector2f::Zero();
  const LandingShifts shifts(own_.track, side_);
  alignas(64) PlaceNumbers costs = {};
  for (size_t time = 0; time < kMoments; ++time)
    if (counts_[time] > 0)
      add_nearness(moved_places(leg_, time, own_, shifts), owner_of(own_),
                   {legs_[time].data(), counts_[time]}, kClear_m, target_, costs);
  size_t best = 0;
  for (size_t i = 0; i < shifts.count; ++i) {
    const float along = shifts.along[i], aside = shifts.aside[i];
    costs[i] += kEffort * (along * along + 2 * aside * aside);
    if (costs[i] < costs[best]) best = i;
  }
  return {shifts.along[best], shifts.aside[best]};
}

}  // namespace throng
