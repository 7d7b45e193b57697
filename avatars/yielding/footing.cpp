#include "avatars/yielding/footing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace throng {
namespace {

using Eigen::Vector2f;

// A foot, seen from above, as what is near a line along it; from below the ankle (adult at scale
// 1).
constexpr float kHeel_m = -0.01f, kToe_m = 0.165f, kHalfWidth_m = 0.05f;
constexpr float kShin_m = 0.055f;
// Feet stay so far apart, and shins.
constexpr float kClear_m = 0.07f;
// A step is changed by so much at most: in length, and to the side.
constexpr float kStep_m = 0.05f;
constexpr int kShortest = -3, kLongest = 2;  // of them
constexpr float kMostAside_m = 0.1f,
                kInwards = 0.9f;  // the latter of the foot's distance from the middle
constexpr float kEffort = 0.003f;
// Shares of the cycle before a foot lands; others' legs that are farther off then do not matter.
constexpr std::array<float, 7> kMomentsBefore = {0.3f, 0.22f, 0.15f, 0.07f, 0, -0.07f, -0.14f};
constexpr float kFarOff_m = 0.7f;
// A foot gets a new place until so shortly before it lands.
constexpr float kWindow_s = 0.9f;
// The rhythm of steps is chosen so far ahead, for those whose roots come so near, and by the time
// in which legs can meet.
constexpr float kRhythmAhead_s = 2.4f, kRhythmReach_m = 0.8f, kLegsReach_m = 1.1f;
// Ways and rhythms are not foreseen so exactly: legs get more room in the choice.
constexpr float kRhythmClear_m = 0.22f;
// Until legs can meet, and for so long at least, steps are shortened or lengthened to get in time;
// then a rhythm is kept.
constexpr float kLeastLead_s = 0.5f;
// Strides are from so much shorter to so much longer than the gait's, in steps of so much.
constexpr float kStretchStep = 0.07f;
constexpr int kFewest = -4, kMost = 2;
constexpr float kLeastStretch = 0.73f, kMostStretch = 1.2f;
// What a second with legs too near by a metre weighs, squared, against a stride of another length
// squared.
constexpr float kNearness = 300, kRhythmEffort = 0.3f, kRhythmChange = 0.2f;
constexpr int kTimes = 10;
// Among more than so many people, so near, nobody keeps step with all of them.
constexpr int kMostAround = 3;
constexpr float kAround_m = 1.1f;
// What meets later than this is left to a later choice.
constexpr float kSoonEnough_s = 1.6f;
// Whoever hardly walks has no rhythm.
constexpr float kSlowest_hz = 0.1f, kSlowest_mps = 0.3f;

Vector2f left_of(const Vector2f& v) { return {-v.y(), v.x()}; }

/// Between the lines along two feet, from the first to the second, if they point the same way or
/// the opposite one, nearly.
float between_feet2(const Vector2f& a, const Vector2f& a_ahead, float a_scale, const Vector2f& b,
                    const Vector2f& b_ahead, float b_scale) {
  float least = std::numeric_limits<float>::infinity();
  for (const float along : {kHeel_m, 0.5f * (kHeel_m + kToe_m), kToe_m}) {
    const Vector2f point = a + a_scale * along * a_ahead;
    const float at = std::clamp(b_ahead.dot(point - b), b_scale * kHeel_m, b_scale * kToe_m);
    least = std::min(least, (point - (b + at * b_ahead)).squaredNorm());
  }
  return least;
}

float lack(float distance2, float reach) {
  return distance2 < reach * reach ? reach - std::sqrt(distance2) : 0;
}

/// How much too near legs are to each other: squares.
float too_near(const Steps& own, const LegPlace& mine, const Vector2f& moved, const Steps& other,
               const LegPlace& there, float clear_m) {
  // Of legs whose feet are so far apart nothing meets.
  constexpr float kFar_m = 0.8f;
  if ((there.foot_m - mine.foot_m - moved).squaredNorm() > kFar_m * kFar_m) return 0;
  const float scales = own.scale + other.scale;
  const float feet = lack(between_feet2(mine.foot_m + moved, own.ahead, own.scale, there.foot_m,
                                        other.ahead, other.scale),
                          kHalfWidth_m * scales + clear_m);
  const float reach = kShin_m * scales + clear_m;
  const float shins = lack((there.shin_m - mine.shin_m - 0.75f * moved).squaredNorm(), reach);
  const float knees = lack((there.knee_m - mine.knee_m - 0.5f * moved).squaredNorm(), reach);
  return feet * feet + shins * shins + knees * knees;
}

/// Another's leg in the way.
struct Obstruction {
  LegPlace place;
  const Steps* owner;
  const struct Moment* moment;
};
constexpr size_t kMostObstructions = 64;

/// A foot on its way.
struct Moment {
  float ahead_s;
  LegPlace place;
};
constexpr size_t kMoments = kMomentsBefore.size();

/// Somebody whose legs could meet one's own, and when.
struct Companion {
  const Steps* steps;
  float from_s, per_s;  ///< kTimes of these from then on
  std::array<std::array<LegPlace, 2>, kTimes> legs;

  float time_s(size_t k) const { return from_s + (static_cast<float>(k) + 0.5f) * per_s; }
};

/// Whether they come near; sets all but the legs.
bool comes_near(const Steps& own, const Steps& other, Companion& companion) {
  const Vector2f way = other.root_m - own.root_m, closing = other.velocity_mps - own.velocity_mps;
  const float speed2 = std::max(closing.squaredNorm(), 1e-4f);
  const float middle_s = -way.dot(closing) / speed2;
  const float nearest_s = std::clamp(middle_s, 0.0f, kRhythmAhead_s);
  if ((way + nearest_s * closing).squaredNorm() > kRhythmReach_m * kRhythmReach_m) return false;
  const float least2 = (way + middle_s * closing).squaredNorm();
  const float half_s = std::sqrt(std::max(kLegsReach_m * kLegsReach_m - least2, 0.0f) / speed2);
  companion.steps = &other;
  companion.from_s = std::clamp(middle_s - half_s, 0.0f, kRhythmAhead_s);
  companion.per_s =
      (std::clamp(middle_s + half_s, 0.0f, kRhythmAhead_s) - companion.from_s) / kTimes;
  return true;
}

class RhythmChoice {
 public:
  RhythmChoice(const Steps& own, std::span<const Steps> near, float now)
      : own_(own),
        now_(now),
        natural_ps_(own.velocity_mps.dot(own.ahead) / (own.track.stride_m * own.scale)) {
    own_.landing_m = {};
    float from_s = kRhythmAhead_s;
    for (const Steps& other : near) {
      if (count_ == companions_.size()) break;
      Companion& companion = companions_[count_];
      if (!comes_near(own, other, companion) || companion.from_s > kSoonEnough_s) continue;
      from_s = std::min(from_s, companion.from_s);
      const std::array<LegPath, 2> paths = {LegPath(other, 0, kRhythmAhead_s),
                                            LegPath(other, 1, kRhythmAhead_s)};
      for (size_t k = 0; k < kTimes; ++k)
        for (size_t side = 0; side < 2; ++side)
          companion.legs[k][side] = paths[side].at(companion.time_s(k));
      ++count_;
    }
    own_.later_s = std::max(from_s, kLeastLead_s);
  }

  /// Every other stretch first, then those beside the best.
  float best() {
    if (count_ == 0) return 1;
    try_out(now_, now_);
    for (int i = kFewest; i <= kMost; i += 2) {
      const float stretch = 1 + kStretchStep * static_cast<float>(i);
      try_out(stretch, 1);
      for (size_t k = 0; k < count_; ++k) {
        const float theirs_ps = companions_[k].steps->cycles_ps;
        if (theirs_ps > kSlowest_hz)
          try_out(stretch, std::clamp(natural_ps_ / theirs_ps, kLeastStretch, kMostStretch));
      }
    }
    const float coarse = best_, later = later_;
    for (const float side : {-kStretchStep, kStretchStep})
      try_out(std::clamp(coarse + side, kLeastStretch, kMostStretch), later);
    return best_;
  }

 private:
  /// Strides stretched by so much, and later by another.
  void try_out(float stretch, float later) {
    own_.cycles_ps = natural_ps_ / stretch;
    own_.later_ps = natural_ps_ / later;
    const auto square = [](float x) { return x * x; };
    float cost = kRhythmEffort * (square(stretch - 1) + square(later - 1)) +
                 kRhythmChange * square(stretch - now_);
    if (cost >= least_) return;
    const std::array<LegPath, 2> paths = {LegPath(own_, 0, kRhythmAhead_s),
                                          LegPath(own_, 1, kRhythmAhead_s)};
    for (size_t i = 0; i < count_; ++i) {
      const Companion& companion = companions_[i];
      for (size_t k = 0; k < kTimes && cost < least_; ++k)
        for (const LegPath& path : paths) {
          const LegPlace mine = path.at(companion.time_s(k));
          for (const LegPlace& theirs : companion.legs[k])
            cost +=
                kNearness * companion.per_s *
                too_near(own_, mine, Vector2f::Zero(), *companion.steps, theirs, kRhythmClear_m);
        }
    }
    if (cost >= least_) return;
    least_ = cost;
    best_ = stretch;
    later_ = later;
  }

  Steps own_;
  float now_;
  float natural_ps_;  ///< with the gait's own strides
  std::array<Companion, 2> companions_;
  size_t count_ = 0;
  float best_ = 1, later_ = 1;
  float least_ = std::numeric_limits<float>::infinity();
};

}  // namespace

float stretch_for(const Steps& own, std::span<const Steps> near, float now) {
  if (own.cycles_ps < kSlowest_hz || own.velocity_mps.dot(own.ahead) < kSlowest_mps) return 1;
  const auto around = std::count_if(near.begin(), near.end(), [&own](const Steps& other) {
    return (other.root_m - own.root_m).squaredNorm() < kAround_m * kAround_m;
  });
  if (around > kMostAround) return 1;
  return RhythmChoice(own, near, now).best();
}

Vector2f landing_shift_m(const Steps& own, size_t side, std::span<const Steps> near) {
  Steps unshifted = own;
  unshifted.landing_m = {};
  const LegPath path(unshifted, side, 2 * kWindow_s);
  const float lands_s = path.lands_s();
  if (lands_s < 0 || lands_s > kWindow_s) return Vector2f::Zero();
  // From the last part of the swing on.
  std::array<Moment, kMoments> moments;
  for (size_t i = 0; i < kMoments; ++i) {
    const float before = kMomentsBefore[i];
    Moment& moment = moments[i];
    moment.ahead_s = std::max(lands_s - before / own.cycles_ps, 0.0f);
    moment.place = path.at(moment.ahead_s);
  }
  std::array<Obstruction, kMostObstructions> all;
  size_t count = 0;
  const Vector2f landing_m = path.at(lands_s).foot_m;
  bool is_free = true;
  for (const Steps& other : near) {
    // Of somebody so far from where the foot lands no leg is in its way.
    constexpr float kFar_m = 1.2f;
    const Vector2f then = other.root_m + lands_s * other.velocity_mps;
    if ((then - landing_m).squaredNorm() > kFar_m * kFar_m) continue;
    for (size_t foot = 0; foot < 2; ++foot) {
      const LegPath leg(other, foot, 2 * kWindow_s);
      for (const Moment& moment : moments) {
        const LegPlace there = leg.at(moment.ahead_s);
        if (!there.stays || count == kMostObstructions) continue;
        if ((there.foot_m - moment.place.foot_m).squaredNorm() > kFarOff_m * kFarOff_m) continue;
        all[count++] = {there, &other, &moment};
        is_free =
            is_free && too_near(own, moment.place, Vector2f::Zero(), other, there, kClear_m) == 0;
      }
    }
  }
  if (is_free) return Vector2f::Zero();
  // Feet do not cross.
  const float inwards = kInwards * std::abs(own.track.side_m[side]);
  const float right = side == 0 ? -kMostAside_m : -inwards,
              left = side == 0 ? inwards : kMostAside_m;
  Vector2f best = Vector2f::Zero();
  float least = std::numeric_limits<float>::infinity();
  for (int i = kShortest; i <= kLongest; ++i)
    for (const float aside : {0.0f, 0.5f * right, right, 0.5f * left, left}) {
      const float along = kStep_m * static_cast<float>(i);
      const Vector2f shift = own.scale * (along * own.ahead + aside * left_of(own.ahead));
      float cost = kEffort * (along * along + 2 * aside * aside);
      for (size_t k = 0; k < count && cost < least; ++k) {
        const Moment& moment = *all[k].moment;
        cost += too_near(own, moment.place, moment.place.share * shift, *all[k].owner, all[k].place,
                         kClear_m);
      }
      if (cost >= least) continue;
      least = cost;
      best = {along, aside};
    }
  return best;
}

}  // namespace throng
