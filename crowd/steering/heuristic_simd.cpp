// Agents as lanes: heuristic.cpp, operation for operation.
#include <cstddef>
#include <cstdint>

#include "base/simd/dispatch.h"
#include "crowd/steering/heuristic.h"
#include "crowd/steering/heuristic_tuning.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "crowd/steering/heuristic_simd.cpp"
#include <hwy/foreach_target.h>

#include "crowd/steering/half_planes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace heuristic {
namespace {

using throng::heuristic::kAgainst;
using throng::heuristic::kAligned;
using throng::heuristic::kFar_m;
using throng::heuristic::kMaxApproach_mps;
using throng::heuristic::kMinBlocks;
using throng::heuristic::kMinPreferred_mps;
using throng::heuristic::kOncoming_mps;
using throng::heuristic::kRadius_m;
using throng::heuristic::kRightSine;
using throng::heuristic::kSameDirection;
using throng::heuristic::kSeenFrom;
using throng::heuristic::kSeenWholly;
using throng::heuristic::kSixth;
using throng::heuristic::kTuning;
using throng::heuristic::kTurned;
using throng::heuristic::kTurns;
using throng::heuristic::Turns;

HWY_INLINE V all(float value) { return hn::Set(D(), value); }
HWY_INLINE V select(M mask, V yes, V no) { return hn::IfThenElse(mask, yes, no); }
HWY_INLINE V clamp(V x, float low, float high) { return hn::Min(all(high), hn::Max(all(low), x)); }
HWY_INLINE V square(V x) { return x * x; }

struct Vectors {
  V x, y;
};
HWY_INLINE Vectors operator+(Vectors a, Vectors b) { return {a.x + b.x, a.y + b.y}; }
HWY_INLINE Vectors operator-(Vectors a, Vectors b) { return {a.x - b.x, a.y - b.y}; }
HWY_INLINE Vectors operator*(V s, Vectors a) { return {s * a.x, s * a.y}; }
HWY_INLINE Vectors operator/(Vectors a, V s) { return {a.x / s, a.y / s}; }
HWY_INLINE Vectors select(M mask, Vectors yes, Vectors no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y)};
}
HWY_INLINE V dot(Vectors a, Vectors b) { return a.x * b.x + a.y * b.y; }
HWY_INLINE V cross(Vectors a, Vectors b) { return a.x * b.y - a.y * b.x; }
HWY_INLINE V length(Vectors a) { return hn::Sqrt(dot(a, a)); }

HWY_INLINE V saturated(V x) {
  return x / hn::Sqrt(hn::Sqrt(hn::Sqrt(all(1) + square(square(square(x))))));
}

/// The k-th neighbour of each lane; absent ones hold arbitrary values.
struct Others {
  M is_there;
  Vectors offset_m, velocity_mps, expected_mps, direction;
  V size, impatience, square_m2;
};

class Decisions {
 public:
  HWY_INLINE Decisions(const SteeringView& people, const AgentLanes& own)
      : p_(people), own_(own), walls_(people, own) {
    const NeighbourLanes self(people, own.slots);
    const M in = hn::FirstN(D(), own.count);
    radius_m_ = self.radius_m;
    size_ = radius_m_ / all(kRadius_m);
    max_speed_mps_ = self.max_speed_mps;
    impatience_ = self.impatience;
    catch_up_ = self.catch_up;
    const Vectors preferred{self.preferred_x_mps, self.preferred_y_mps};
    preferred_mps_ = length(preferred);
    wants_to_move_ = hn::And(in, preferred_mps_ > all(kMinPreferred_mps));
    direction_ = select(wants_to_move_, preferred / preferred_mps_, {all(0), all(0)});
    velocity_mps_ = {self.vx_mps, self.vy_mps};
    speed_mps_ = length(velocity_mps_);
    load_neighbours({self.x_m, self.y_m});
  }

  HWY_INLINE void decide(float* next_x_mps, float* next_y_mps) const {
    Vectors aside = drift(), preferred{all(0), all(0)};
    if (!hn::AllFalse(D(), wants_to_move_)) {
      const Vectors direction = best_direction();
      preferred = select(wants_to_move_, speed_along(direction) * direction, preferred);
      const V along = dot(aside, direction);
      aside = select(hn::And(wants_to_move_, along > all(0)), aside - along * direction, aside);
    }
    const Vectors next = limit_acceleration(avoid_bodies(approach(preferred + aside)));
    own_.store(next.x, next_x_mps);
    own_.store(next.y, next_y_mps);
  }

 private:
  HWY_INLINE M is_against(const Others& o) const {
    return dot(direction_, o.direction) < all(kAgainst);
  }

  HWY_INLINE void load_neighbours(Vectors place) {
    const NeighbourSlots near(p_, own_);
    count_ = near.count;
    for (size_t k = 0; k < count_; ++k) {
      const NeighbourLanes other(p_, near.of(k));
      Others& o = others_[k];
      o.is_there = near.has(k);
      o.offset_m = Vectors{other.x_m, other.y_m} - place;
      o.square_m2 = dot(o.offset_m, o.offset_m);
      const M same = o.square_m2 == all(0);
      const V apart = select(near.is_before(k, own_), all(1e-3f), all(-1e-3f));
      o.offset_m.x = select(same, apart, o.offset_m.x);
      o.square_m2 = select(same, square(apart), o.square_m2);
      o.velocity_mps = {other.vx_mps, other.vy_mps};
      const Vectors preferred{other.preferred_x_mps, other.preferred_y_mps};
      o.expected_mps = o.velocity_mps + all(kTuning.preferred_share) * (preferred - o.velocity_mps);
      o.direction = {other.direction_x, other.direction_y};
      o.size = all(0.5f) * (size_ + other.radius_m / all(kRadius_m));
      o.impatience = hn::Max(other.impatience, impatience_);
    }
    openness_ = all(1);
    in_crowd_ = hn::FirstN(D(), 0);
    if (count_ <= kSixth) return;
    in_crowd_ = others_[kSixth].is_there;
    const V sixth_m = hn::Sqrt(others_[kSixth].square_m2);
    const V open = (sixth_m - all(kTuning.dense_m)) / all(kTuning.open_m - kTuning.dense_m);
    openness_ = select(in_crowd_, clamp(open, 0, 1), openness_);
  }

  HWY_INLINE Vectors drift() const {
    Vectors sum{all(0), all(0)};
    const V walking_apart_m =
        all(kTuning.apart_m) + openness_ * all(kTuning.open_apart_m - kTuning.apart_m);
    const V apart_m = select(wants_to_move_, walking_apart_m, all(kTuning.waits_apart_m));
    const V drift_mps = select(wants_to_move_, (all(1) - impatience_) * all(kTuning.drift_mps),
                               all(kTuning.waits_drift_mps));
    for (size_t k = 0; k < count_; ++k) {
      const Others& o = others_[k];
      const V distance_m = hn::Sqrt(o.square_m2);
      const V deficit = clamp((apart_m * o.size - distance_m) / all(kTuning.drift_m), 0, 2);
      const Vectors off = drift_mps * deficit / distance_m * o.offset_m;
      sum = select(o.is_there, sum - off, sum);
    }
    for (size_t w = 0; w < walls_.count; ++w) {
      const V gap_m = wall_clearance_m(w) + radius_m_ - all(kTuning.wall_m);
      const V deficit = clamp(all(1) - gap_m / all(kTuning.wall_drift_m), 0, 2);
      sum = sum + all(kTuning.wall_drift_mps) * deficit * wall(w);
    }
    return sum + all(kTuning.side_mps) * counterflow() * right_clearance() * right();
  }

  HWY_INLINE V right_clearance() const {
    V clearance = all(1);
    for (size_t w = 0; w < walls_.count; ++w) {
      const M to_right = cross(direction_, wall(w)) > all(kRightSine);
      const V gap_m = wall_clearance_m(w) + radius_m_ - all(kTuning.side_from_m);
      const V left = clamp(gap_m / all(kTuning.side_range_m), 0, 1);
      clearance = select(to_right, hn::Min(clearance, left), clearance);
    }
    return clearance;
  }

  HWY_INLINE Vectors right() const { return {direction_.y, hn::Neg(direction_.x)}; }

  HWY_INLINE V counterflow() const {
    V oncoming = all(0);
    for (size_t k = 0; k < count_; ++k) {
      const Others& o = others_[k];
      const M comes = hn::And(is_against(o), dot(o.offset_m, direction_) > all(0));
      oncoming = select(hn::And(o.is_there, comes), oncoming + all(1), oncoming);
    }
    return hn::Min(oncoming / all(kTuning.oncoming), all(1));
  }

  HWY_INLINE Vectors wall(size_t w) const {
    return {hn::Load(D(), walls_.x + w * kLanes), hn::Load(D(), walls_.y + w * kLanes)};
  }
  HWY_INLINE V wall_clearance_m(size_t w) const {
    return hn::Load(D(), walls_.clearance_m + w * kLanes);
  }

  struct Candidates {
    Vectors to[Turns::kCount];
    V free_m[Turns::kCount], per[Turns::kCount];
  };

  HWY_INLINE V visible_share(const Others& o) const {
    const V cosine = dot(direction_, o.offset_m) / hn::Sqrt(o.square_m2);
    const V visible = clamp((cosine - all(kSeenFrom)) / all(kSeenWholly - kSeenFrom), 0, 1);
    return select(in_crowd_, visible, all(1));
  }

  HWY_INLINE void limit_by_agent(const Others& o, Candidates& candidates) const {
    const V visible = visible_share(o);
    const M counts = hn::And(o.is_there, visible > all(0));
    if (hn::AllFalse(D(), counts)) return;
    const M same_direction = dot(direction_, o.direction) > all(kSameDirection);
    const V open = select(same_direction, all(1), openness_);
    const V size = (all(1) - all(kTuning.max_passing_compression) * o.impatience) * o.size;
    const V blocked_m = (all(kTuning.blocked_m) + open * all(kTuning.open_blocked_m)) * size;
    const V clear_m = (all(kTuning.clear_m) + open * all(kTuning.open_clear_m)) * size;
    const V per_m2 = all(1) / o.square_m2;
    const V blocked = square(blocked_m) * per_m2, clear = square(clear_m) * per_m2;
    const V max_weight = visible * per_m2 / preferred_mps_, partly = max_weight / (clear - blocked);
    const V min_weight = all(kMinBlocks) * max_weight;
    const V ahead = preferred_mps_ * dot(o.offset_m, direction_);
    const V to_left = preferred_mps_ * cross(direction_, o.offset_m);
    const V its_nearing = dot(o.offset_m, o.expected_mps);
    const V its_passing = cross(o.offset_m, o.expected_mps);
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const V cos = all(kTurns.cos[i]), sin = all(kTurns.sin[i]);
      const V nearing = cos * ahead - its_nearing + sin * to_left;
      const V passing = sin * ahead - (cos * to_left + its_passing);
      const V miss = passing * passing, both = nearing * nearing + miss;
      const V lacks = clear * both - miss;
      const V before = hn::Sqrt(hn::Max(blocked * both - miss, all(0)));
      const V blocks = hn::Min(hn::Max(lacks * partly, min_weight * both), max_weight * both);
      const V free_product = hn::Max(nearing - before, all(0));
      const M is_met = hn::And(counts, hn::And(nearing > all(0), lacks > all(0)));
      const M is_less =
          hn::And(is_met, free_product * candidates.per[i] < candidates.free_m[i] * blocks);
      candidates.free_m[i] = select(is_less, free_product, candidates.free_m[i]);
      candidates.per[i] = select(is_less, blocks, candidates.per[i]);
    }
  }

  HWY_INLINE void limit_by_wall(size_t w, Candidates& candidates) const {
    const Vectors away = wall(w);
    const V distance_m = wall_clearance_m(w) + radius_m_;
    const V clear_m = hn::Min(all(kTuning.wall_m) * size_, all(0.95f) * distance_m);
    const V min_weight = hn::Max(hn::Neg(dot(away, direction_)), all(0)) + all(1e-3f);
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const V into = hn::Neg(dot(away, candidates.to[i]));
      const V miss_square = square(distance_m) * hn::Max(all(1) - into * into, all(0));
      const V chord_m2 = square(clear_m) - miss_square;
      const V free_m = hn::Max(distance_m * into - hn::Sqrt(hn::Max(chord_m2, all(0))), all(0));
      const M is_met = hn::And(into > min_weight, chord_m2 > all(0));
      candidates.free_m[i] =
          select(is_met, hn::Min(candidates.free_m[i], free_m), candidates.free_m[i]);
    }
  }

  HWY_INLINE Vectors best_direction() const {
    Candidates candidates;
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const V cos = all(kTurns.cos[i]), sin = all(kTurns.sin[i]);
      candidates.to[i] = {cos * direction_.x - sin * direction_.y,
                          cos * direction_.y + sin * direction_.x};
      candidates.free_m[i] = all(kFar_m);
      candidates.per[i] = all(1);
    }
    for (size_t k = 0; k < count_; ++k) limit_by_agent(others_[k], candidates);
    for (size_t i = 0; i < Turns::kCount; ++i)
      candidates.free_m[i] = candidates.free_m[i] / candidates.per[i];
    for (size_t w = 0; w < walls_.count; ++w) limit_by_wall(w, candidates);
    return best_of(candidates);
  }

  HWY_INLINE Vectors best_of(const Candidates& candidates) const {
    constexpr size_t kStraight = Turns::kStraight, kLast = Turns::kLast;
    const V keep = all(kTuning.inertia) *
                   hn::Min(all(1) / hn::Max(speed_mps_, all(1e-3f)), all(1) / preferred_mps_);
    const V straight_m = candidates.free_m[kStraight];
    const V keep_right =
        select(straight_m < all(kFar_m),
               (all(1) - impatience_) * all(kTuning.keep_right * kTuning.horizon_m) /
                   (straight_m + all(kTuning.horizon_m)),
               all(0));
    V worth[Turns::kCount];
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const float to_left = kTurns.sin[i] > 0 ? kTurns.sin[i] : 0;
      worth[i] = all(kTurns.cos[i]) * candidates.free_m[i] /
                     (candidates.free_m[i] + all(kTuning.horizon_m)) +
                 keep * dot(candidates.to[i], velocity_mps_) - keep_right * all(to_left);
    }
    V best = worth[kStraight], before = worth[kStraight - 1], after = worth[kStraight + 1];
    Vectors direction = candidates.to[kStraight], right = candidates.to[kStraight - 1],
            left = candidates.to[kStraight + 1];
    M is_between = hn::FirstN(D(), kLanes);
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const size_t previous = i == 0 ? i : i - 1, next = i == kLast ? i : i + 1;
      const M better = worth[i] > best;
      best = select(better, worth[i], best);
      before = select(better, worth[previous], before);
      after = select(better, worth[next], after);
      direction = select(better, candidates.to[i], direction);
      right = select(better, candidates.to[previous], right);
      left = select(better, candidates.to[next], left);
      is_between =
          i == 0 || i == kLast ? hn::AndNot(better, is_between) : hn::Or(better, is_between);
    }
    const V to_left = parabola_minimum(hn::Neg(before), hn::Neg(best), hn::Neg(after));
    const Vectors side = select(to_left > all(0), left, right);
    const Vectors bent = direction + hn::Abs(to_left) * (side - direction);
    const M bends = hn::And(is_between, hn::Not(to_left == all(0)));
    return select(bends, bent / length(bent), direction);
  }

  static HWY_INLINE V parabola_minimum(V before, V here, V after) {
    constexpr float kMinBend = 1e-6f;
    const V bend = before - all(2) * here + after;
    const V step = all(0.5f) * (before - after) / bend;
    return select(bend > all(kMinBend), clamp(step, -0.5f, 0.5f), all(0));
  }

  HWY_INLINE V gap_growth_m(V ahead_m, V faster_mps) const {
    const V follows = clamp(
        (ahead_m - all(kTuning.touching_m)) / all(kTuning.follows_m - kTuning.touching_m), 0, 1);
    const V catch_up_s = all(kTuning.catch_up_s) + all(kTuning.catch_up_s2pm) * faster_mps;
    return (all(kTuning.ahead_s) + catch_up_ * follows * catch_up_s) * faster_mps;
  }

  HWY_INLINE V speed_along(Vectors direction) const {
    V gap_m = all(kFar_m);
    for (size_t k = 0; k < count_; ++k) {
      const Others& o = others_[k];
      const V cosine = dot(direction, o.direction);
      const V same = clamp((cosine - all(kSameDirection)) / all(kAligned - kSameDirection), 0, 1);
      const Vectors sum = direction + same * o.direction;
      const Vectors along = sum / length(sum);
      const V ahead_m = dot(o.offset_m, along);
      const V aside_m = hn::Abs(cross(o.offset_m, along));
      const V other_mps = dot(o.velocity_mps, direction);
      const M is_met = hn::Or(other_mps < all(kOncoming_mps), is_against(o));
      const V shoulders_m = select(is_met, all(kTuning.passing_m) * (all(1) - o.impatience),
                                   all(kTuning.shoulders_m)) *
                            o.size;
      const M is_ahead = hn::And(ahead_m > all(0), aside_m < shoulders_m);
      const M waits = hn::And(same == all(0), hn::Neg(dot(o.offset_m, o.direction)) > ahead_m);
      const M counts = hn::And(o.is_there, hn::AndNot(waits, is_ahead));
      if (hn::AllFalse(D(), counts)) continue;
      const V round = hn::Sqrt(hn::Sqrt(all(1) - square(square(aside_m / shoulders_m))));
      const V faster_mps = hn::Max(other_mps - speed_mps_, all(0));
      const V each_m = ahead_m - all(kTuning.stand_m) * o.size * round +
                       gap_growth_m(ahead_m / o.size, faster_mps);
      gap_m = select(counts, hn::Min(each_m, gap_m), gap_m);
    }
    return preferred_mps_ * saturated(hn::Max(gap_m, all(0)) / all(kTuning.gap_range_m));
  }

  HWY_INLINE Vectors approach(Vectors preferred) const {
    const M slows = dot(preferred, preferred) < dot(velocity_mps_, velocity_mps_);
    const V share = select(slows, all(p_.period_s / kTuning.slow_down_s),
                           all(p_.period_s / kTuning.speed_up_s));
    const Vectors change = hn::Min(all(1), share) * (preferred - velocity_mps_);
    const float max_mps = kTuning.across_mps2 * p_.period_s;
    const V to_right_mps = dot(change, right());
    return velocity_mps_ + change -
           (to_right_mps - clamp(to_right_mps, -max_mps, max_mps)) * right();
  }

  HWY_INLINE V squared_ahead_cosine(const Others& o) const {
    const Vectors v = velocity_mps_ - o.velocity_mps;
    const V nearest_s =
        clamp(dot(o.offset_m, v) / hn::Max(dot(v, v), all(1e-4f)), 0, kTuning.body_horizon_s);
    const Vectors there = o.offset_m - nearest_s * v;
    const V square_m2 = hn::Max(dot(there, there), all(1e-6f));
    const V half = all(0.5f) * square_m2;
    const V own = select(wants_to_move_, square(dot(there, direction_)), half);
    const M it_stands = hn::And(o.direction.x == all(0), o.direction.y == all(0));
    const V its = select(it_stands, half, square(dot(there, o.direction)));
    return all(0.5f) * (own + its) / square_m2;
  }

  HWY_INLINE Vectors avoid_bodies(Vectors preferred) const {
    PlaneLanes planes;
    add_walls(walls_, all(kTurned) * radius_m_, p_.wall_horizon_s, planes);
    planes.add_hard(wants_to_move_, hn::Neg(direction_.x), hn::Neg(direction_.y),
                    hn::Neg(hn::Max(all(0), dot(direction_, preferred))));
    const V body_width_m =
        all(kTuning.body_width_m) * (all(1) - all(kTuning.shoulder_turn) * (all(1) - openness_));
    Encounters e;
    e.own_x = velocity_mps_.x;
    e.own_y = velocity_mps_.y;
    e.horizon_rate = e.step_rate = all(1 / kTuning.body_horizon_s);
    e.share = all(0.5f);
    M near = hn::FirstN(D(), own_.count);
    for (size_t k = 0; k < count_; ++k) {
      const Others& o = others_[k];
      const V body_m =
          body_width_m + (all(kTuning.body_depth_m) - body_width_m) * squared_ahead_cosine(o);
      e.radius_m = body_m * (all(1) - all(kTuning.max_compression) * o.impatience) * o.size;
      const V reach_m = e.radius_m + all(kTuning.body_horizon_s * kMaxApproach_mps);
      near = hn::And(near, hn::And(o.is_there, o.square_m2 <= square(reach_m)));
      if (hn::AllFalse(D(), near)) break;  // neighbours are sorted by distance
      e.offset_x = o.offset_m.x;
      e.offset_y = o.offset_m.y;
      e.other_x = o.velocity_mps.x;
      e.other_y = o.velocity_mps.y;
      add_avoiding(e, near, planes);
    }
    return choose(planes, hn::FirstN(D(), own_.count), preferred);
  }

  HWY_INLINE Vectors choose(const PlaneLanes& planes, M in, Vectors preferred) const {
    Vectors v;
    choose_velocities(planes, in, preferred.x, preferred.y, max_speed_mps_, v.x, v.y);
    return v;
  }

  HWY_INLINE Vectors limit_acceleration(Vectors velocity) const {
    const Vectors change = velocity - velocity_mps_;
    const V change_mps = length(change), max_change = all(kTuning.max_mps2 * p_.period_s);
    const M is_more = hn::And(hn::FirstN(D(), own_.count), change_mps > max_change);
    if (hn::AllFalse(D(), is_more)) return velocity;
    PlaneLanes planes;
    add_walls(walls_, all(kTurned) * radius_m_, p_.wall_horizon_s, planes);
    return select(is_more,
                  choose(planes, is_more, velocity_mps_ + max_change / change_mps * change),
                  velocity);
  }

  const SteeringView& p_;
  const AgentLanes& own_;
  WallLanes walls_;
  Others others_[NeighbourGrid::kMaxNeighbours];
  size_t count_ = 0;
  Vectors direction_, velocity_mps_;
  V radius_m_, size_, max_speed_mps_, catch_up_, impatience_;
  V preferred_mps_, speed_mps_, openness_;
  M wants_to_move_, in_crowd_;
};

}  // namespace
}  // namespace heuristic

void decide_heuristic_all(const SteeringView& people, std::span<const uint32_t> slots,
                          float* next_x_mps, float* next_y_mps) {
  for (size_t first = 0; first < slots.size(); first += kLanes)
    heuristic::Decisions(people, AgentLanes(slots, first)).decide(next_x_mps, next_y_mps);
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

SteeringFunction heuristic_on(SimdTarget target) {
  return THRONG_CHOOSE(resolved(target), decide_heuristic_all, decide_heuristic_scalar);
}

}  // namespace throng
#endif
