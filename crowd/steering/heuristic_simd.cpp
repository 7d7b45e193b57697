// People as lanes: heuristic.cpp, operation for operation.
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
using throng::heuristic::kAlong;
using throng::heuristic::kFar_m;
using throng::heuristic::kFastest_mps;
using throng::heuristic::kLeastBlocks;
using throng::heuristic::kOncoming_mps;
using throng::heuristic::kRadius_m;
using throng::heuristic::kSameWay;
using throng::heuristic::kSeenFrom;
using throng::heuristic::kSeenWholly;
using throng::heuristic::kSixth;
using throng::heuristic::kToRight;
using throng::heuristic::kTuning;
using throng::heuristic::kTurned;
using throng::heuristic::kTurns;
using throng::heuristic::kWants_mps;
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

/// Of every lane the k-th neighbour; those that are not there hold anything.
struct Others {
  M is_there;
  Vectors offset_m, velocity_mps, expected_mps, way;
  V size, urge, square_m2;
};

/// A Decision a lane.
class Decisions {
 public:
  HWY_INLINE Decisions(const SteeringView& people, const LanesOfPeople& own)
      : p_(people), own_(own), walls_(people, own) {
    const LanesOfSeen self(people, own.slots);
    const M in = hn::FirstN(D(), own.count);
    radius_m_ = self.radius_m;
    size_ = radius_m_ / all(kRadius_m);
    max_speed_mps_ = self.max_speed_mps;
    urge_ = self.urge;
    eagerness_ = self.eagerness;
    const Vectors wanted{self.wanted_x_mps, self.wanted_y_mps};
    wanted_mps_ = length(wanted);
    wants_ = hn::And(in, wanted_mps_ > all(kWants_mps));
    way_ = select(wants_, wanted / wanted_mps_, {all(0), all(0)});
    velocity_mps_ = {self.vx_mps, self.vy_mps};
    speed_mps_ = length(velocity_mps_);
    see_others({self.x_m, self.y_m});
  }

  HWY_INLINE void decide(float* next_x_mps, float* next_y_mps) const {
    Vectors aside = drift(), wish{all(0), all(0)};
    if (!hn::AllFalse(D(), wants_)) {
      const Vectors way = best_way();
      wish = select(wants_, speed_on(way) * way, wish);
      const V along = dot(aside, way);
      aside = select(hn::And(wants_, along > all(0)), aside - along * way, aside);
    }
    const Vectors next = at_most(between_bodies(towards(wish + aside)));
    own_.store(next.x, next_x_mps);
    own_.store(next.y, next_y_mps);
  }

 private:
  HWY_INLINE M is_against(const Others& o) const { return dot(way_, o.way) < all(kAgainst); }

  HWY_INLINE void see_others(Vectors place) {
    const LanesOfNeighbours near(p_, own_);
    count_ = near.most;
    for (size_t k = 0; k < count_; ++k) {
      const LanesOfSeen other(p_, near.of(k));
      Others& o = others_[k];
      o.is_there = near.has(k);
      o.offset_m = Vectors{other.x_m, other.y_m} - place;
      o.square_m2 = dot(o.offset_m, o.offset_m);
      const M same = o.square_m2 == all(0);
      const V apart = select(near.is_before(k, own_), all(1e-3f), all(-1e-3f));
      o.offset_m.x = select(same, apart, o.offset_m.x);
      o.square_m2 = select(same, square(apart), o.square_m2);
      o.velocity_mps = {other.vx_mps, other.vy_mps};
      const Vectors wanted{other.wanted_x_mps, other.wanted_y_mps};
      o.expected_mps = o.velocity_mps + all(kTuning.intent) * (wanted - o.velocity_mps);
      o.way = {other.way_x, other.way_y};
      o.size = all(0.5f) * (size_ + other.radius_m / all(kRadius_m));
      o.urge = hn::Max(other.urge, urge_);
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
    const V apart_m = select(wants_, walking_apart_m, all(kTuning.waits_apart_m));
    const V drift_mps =
        select(wants_, (all(1) - urge_) * all(kTuning.drift_mps), all(kTuning.waits_drift_mps));
    for (size_t k = 0; k < count_; ++k) {
      const Others& o = others_[k];
      const V distance_m = hn::Sqrt(o.square_m2);
      const V lack = clamp((apart_m * o.size - distance_m) / all(kTuning.drift_m), 0, 2);
      const Vectors off = drift_mps * lack / distance_m * o.offset_m;
      sum = select(o.is_there, sum - off, sum);
    }
    for (size_t w = 0; w < walls_.count; ++w) {
      const V gap_m = wall_clearance_m(w) + radius_m_ - all(kTuning.wall_m);
      const V lack = clamp(all(1) - gap_m / all(kTuning.wall_drift_m), 0, 2);
      sum = sum + all(kTuning.wall_drift_mps) * lack * wall(w);
    }
    return sum + all(kTuning.side_mps) * counterflow() * room_to_right() * right();
  }

  HWY_INLINE V room_to_right() const {
    V room = all(1);
    for (size_t w = 0; w < walls_.count; ++w) {
      const M to_right = cross(way_, wall(w)) > all(kToRight);
      const V gap_m = wall_clearance_m(w) + radius_m_ - all(kTuning.side_from_m);
      const V left = clamp(gap_m / all(kTuning.side_room_m), 0, 1);
      room = select(to_right, hn::Min(room, left), room);
    }
    return room;
  }

  HWY_INLINE Vectors right() const { return {way_.y, hn::Neg(way_.x)}; }

  HWY_INLINE V counterflow() const {
    V oncoming = all(0);
    for (size_t k = 0; k < count_; ++k) {
      const Others& o = others_[k];
      const M comes = hn::And(is_against(o), dot(o.offset_m, way_) > all(0));
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

  struct Ways {
    Vectors to[Turns::kCount];
    V free_m[Turns::kCount], per[Turns::kCount];
  };

  HWY_INLINE V share_seen(const Others& o) const {
    const V cosine = dot(way_, o.offset_m) / hn::Sqrt(o.square_m2);
    const V seen = clamp((cosine - all(kSeenFrom)) / all(kSeenWholly - kSeenFrom), 0, 1);
    return select(in_crowd_, seen, all(1));
  }

  HWY_INLINE void keep_clear_of(const Others& o, Ways& ways) const {
    const V seen = share_seen(o);
    const M counts = hn::And(o.is_there, seen > all(0));
    if (hn::AllFalse(D(), counts)) return;
    const M same_way = dot(way_, o.way) > all(kSameWay);
    const V open = select(same_way, all(1), openness_);
    const V size = (all(1) - all(kTuning.squeeze_room) * o.urge) * o.size;
    const V blocked_m = (all(kTuning.blocked_m) + open * all(kTuning.open_blocked_m)) * size;
    const V clear_m = (all(kTuning.clear_m) + open * all(kTuning.open_clear_m)) * size;
    const V per_m2 = all(1) / o.square_m2;
    const V blocked = square(blocked_m) * per_m2, clear = square(clear_m) * per_m2;
    const V most = seen * per_m2 / wanted_mps_, partly = most / (clear - blocked);
    const V least = all(kLeastBlocks) * most;
    const V ahead = wanted_mps_ * dot(o.offset_m, way_);
    const V to_left = wanted_mps_ * cross(way_, o.offset_m);
    const V its_nearing = dot(o.offset_m, o.expected_mps);
    const V its_passing = cross(o.offset_m, o.expected_mps);
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const V cos = all(kTurns.cos[i]), sin = all(kTurns.sin[i]);
      const V nearing = cos * ahead - its_nearing + sin * to_left;
      const V passing = sin * ahead - (cos * to_left + its_passing);
      const V miss = passing * passing, both = nearing * nearing + miss;
      const V lacks = clear * both - miss;
      const V before = hn::Sqrt(hn::Max(blocked * both - miss, all(0)));
      const V blocks = hn::Min(hn::Max(lacks * partly, least * both), most * both);
      const V way = hn::Max(nearing - before, all(0));
      const M is_met = hn::And(counts, hn::And(nearing > all(0), lacks > all(0)));
      const M is_less = hn::And(is_met, way * ways.per[i] < ways.free_m[i] * blocks);
      ways.free_m[i] = select(is_less, way, ways.free_m[i]);
      ways.per[i] = select(is_less, blocks, ways.per[i]);
    }
  }

  HWY_INLINE void keep_off_wall(size_t w, Ways& ways) const {
    const Vectors away = wall(w);
    const V distance_m = wall_clearance_m(w) + radius_m_;
    const V clear_m = hn::Min(all(kTuning.wall_m) * size_, all(0.95f) * distance_m);
    const V least = hn::Max(hn::Neg(dot(away, way_)), all(0)) + all(1e-3f);
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const V into = hn::Neg(dot(away, ways.to[i]));
      const V miss_square = square(distance_m) * hn::Max(all(1) - into * into, all(0));
      const V room = square(clear_m) - miss_square;
      const V way_m = hn::Max(distance_m * into - hn::Sqrt(hn::Max(room, all(0))), all(0));
      const M is_met = hn::And(into > least, room > all(0));
      ways.free_m[i] = select(is_met, hn::Min(ways.free_m[i], way_m), ways.free_m[i]);
    }
  }

  HWY_INLINE Vectors best_way() const {
    Ways ways;
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const V cos = all(kTurns.cos[i]), sin = all(kTurns.sin[i]);
      ways.to[i] = {cos * way_.x - sin * way_.y, cos * way_.y + sin * way_.x};
      ways.free_m[i] = all(kFar_m);
      ways.per[i] = all(1);
    }
    for (size_t k = 0; k < count_; ++k) keep_clear_of(others_[k], ways);
    for (size_t i = 0; i < Turns::kCount; ++i) ways.free_m[i] = ways.free_m[i] / ways.per[i];
    for (size_t w = 0; w < walls_.count; ++w) keep_off_wall(w, ways);
    return best_of(ways);
  }

  HWY_INLINE Vectors best_of(const Ways& ways) const {
    constexpr size_t kStraight = Turns::kStraight, kLast = Turns::kLast;
    const V keep = all(kTuning.keep_on) *
                   hn::Min(all(1) / hn::Max(speed_mps_, all(1e-3f)), all(1) / wanted_mps_);
    const V straight_m = ways.free_m[kStraight];
    const V keep_right = select(straight_m < all(kFar_m),
                                (all(1) - urge_) * all(kTuning.keep_right * kTuning.horizon_m) /
                                    (straight_m + all(kTuning.horizon_m)),
                                all(0));
    V worth[Turns::kCount];
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const float to_left = kTurns.sin[i] > 0 ? kTurns.sin[i] : 0;
      worth[i] = all(kTurns.cos[i]) * ways.free_m[i] / (ways.free_m[i] + all(kTuning.horizon_m)) +
                 keep * dot(ways.to[i], velocity_mps_) - keep_right * all(to_left);
    }
    V best = worth[kStraight], before = worth[kStraight - 1], after = worth[kStraight + 1];
    Vectors way = ways.to[kStraight], right = ways.to[kStraight - 1], left = ways.to[kStraight + 1];
    M is_between = hn::FirstN(D(), kLanes);
    for (size_t i = 0; i < Turns::kCount; ++i) {
      const size_t previous = i == 0 ? i : i - 1, next = i == kLast ? i : i + 1;
      const M better = worth[i] > best;
      best = select(better, worth[i], best);
      before = select(better, worth[previous], before);
      after = select(better, worth[next], after);
      way = select(better, ways.to[i], way);
      right = select(better, ways.to[previous], right);
      left = select(better, ways.to[next], left);
      is_between =
          i == 0 || i == kLast ? hn::AndNot(better, is_between) : hn::Or(better, is_between);
    }
    const V to_left = lowest_between(hn::Neg(before), hn::Neg(best), hn::Neg(after));
    const Vectors side = select(to_left > all(0), left, right);
    const Vectors bent = way + hn::Abs(to_left) * (side - way);
    const M bends = hn::And(is_between, hn::Not(to_left == all(0)));
    return select(bends, bent / length(bent), way);
  }

  /// lowest_between() of every lane.
  static HWY_INLINE V lowest_between(V before, V here, V after) {
    constexpr float kLeastBend = 1e-6f;
    const V bend = before - all(2) * here + after;
    const V step = all(0.5f) * (before - after) / bend;
    return select(bend > all(kLeastBend), clamp(step, -0.5f, 0.5f), all(0));
  }

  HWY_INLINE V growth_m(V ahead_m, V faster_mps) const {
    const V follows = clamp(
        (ahead_m - all(kTuning.touching_m)) / all(kTuning.follows_m - kTuning.touching_m), 0, 1);
    const V eager_s = all(kTuning.eager_s) + all(kTuning.eager_s2pm) * faster_mps;
    return (all(kTuning.ahead_s) + eagerness_ * follows * eager_s) * faster_mps;
  }

  HWY_INLINE V speed_on(Vectors way) const {
    V gap_m = all(kFar_m);
    for (size_t k = 0; k < count_; ++k) {
      const Others& o = others_[k];
      const V cosine = dot(way, o.way);
      const V same = clamp((cosine - all(kSameWay)) / all(kAlong - kSameWay), 0, 1);
      const Vectors sum = way + same * o.way;
      const Vectors along = sum / length(sum);
      const V ahead_m = dot(o.offset_m, along);
      const V aside_m = hn::Abs(cross(o.offset_m, along));
      const V other_mps = dot(o.velocity_mps, way);
      const M is_met = hn::Or(other_mps < all(kOncoming_mps), is_against(o));
      const V shoulders_m =
          select(is_met, all(kTuning.passing_m) * (all(1) - o.urge), all(kTuning.shoulders_m)) *
          o.size;
      const M in_way = hn::And(ahead_m > all(0), aside_m < shoulders_m);
      const M waits = hn::And(same == all(0), hn::Neg(dot(o.offset_m, o.way)) > ahead_m);
      const M counts = hn::And(o.is_there, hn::AndNot(waits, in_way));
      if (hn::AllFalse(D(), counts)) continue;
      const V round = hn::Sqrt(hn::Sqrt(all(1) - square(square(aside_m / shoulders_m))));
      const V faster_mps = hn::Max(other_mps - speed_mps_, all(0));
      const V each_m =
          ahead_m - all(kTuning.stand_m) * o.size * round + growth_m(ahead_m / o.size, faster_mps);
      gap_m = select(counts, hn::Min(each_m, gap_m), gap_m);
    }
    return wanted_mps_ * saturated(hn::Max(gap_m, all(0)) / all(kTuning.room_m));
  }

  HWY_INLINE Vectors towards(Vectors wish) const {
    const M slows = dot(wish, wish) < dot(velocity_mps_, velocity_mps_);
    const V share = select(slows, all(p_.period_s / kTuning.slow_down_s),
                           all(p_.period_s / kTuning.speed_up_s));
    const Vectors change = hn::Min(all(1), share) * (wish - velocity_mps_);
    const float most_mps = kTuning.across_mps2 * p_.period_s;
    const V to_right_mps = dot(change, right());
    return velocity_mps_ + change -
           (to_right_mps - clamp(to_right_mps, -most_mps, most_mps)) * right();
  }

  HWY_INLINE V square_of_ahead(const Others& o) const {
    const Vectors v = velocity_mps_ - o.velocity_mps;
    const V nearest_s =
        clamp(dot(o.offset_m, v) / hn::Max(dot(v, v), all(1e-4f)), 0, kTuning.body_s);
    const Vectors there = o.offset_m - nearest_s * v;
    const V square_m2 = hn::Max(dot(there, there), all(1e-6f));
    const V half = all(0.5f) * square_m2;
    const V own = select(wants_, square(dot(there, way_)), half);
    const M it_stands = hn::And(o.way.x == all(0), o.way.y == all(0));
    const V its = select(it_stands, half, square(dot(there, o.way)));
    return all(0.5f) * (own + its) / square_m2;
  }

  HWY_INLINE Vectors between_bodies(Vectors wish) const {
    LanesOfPlanes planes;
    add_walls(walls_, all(kTurned) * radius_m_, p_.wall_horizon_s, planes);
    planes.add_hard(wants_, hn::Neg(way_.x), hn::Neg(way_.y),
                    hn::Neg(hn::Max(all(0), dot(way_, wish))));
    const V wide_m = all(kTuning.wide_m) * (all(1) - all(kTuning.turned) * (all(1) - openness_));
    Encounters e;
    e.own_x = velocity_mps_.x;
    e.own_y = velocity_mps_.y;
    e.horizon_rate = e.step_rate = all(1 / kTuning.body_s);
    e.share = all(0.5f);
    M near = hn::FirstN(D(), own_.count);
    for (size_t k = 0; k < count_; ++k) {
      const Others& o = others_[k];
      const V body_m = wide_m + (all(kTuning.deep_m) - wide_m) * square_of_ahead(o);
      e.radius_m = body_m * (all(1) - all(kTuning.squeeze) * o.urge) * o.size;
      const V reach_m = e.radius_m + all(kTuning.body_s * kFastest_mps);
      near = hn::And(near, hn::And(o.is_there, o.square_m2 <= square(reach_m)));
      if (hn::AllFalse(D(), near)) break;  // they come nearest first
      e.offset_x = o.offset_m.x;
      e.offset_y = o.offset_m.y;
      e.other_x = o.velocity_mps.x;
      e.other_y = o.velocity_mps.y;
      add_avoiding(e, near, planes);
    }
    return choose(planes, hn::FirstN(D(), own_.count), wish);
  }

  HWY_INLINE Vectors choose(const LanesOfPlanes& planes, M in, Vectors wish) const {
    Vectors v;
    choose_velocities(planes, in, wish.x, wish.y, max_speed_mps_, v.x, v.y);
    return v;
  }

  HWY_INLINE Vectors at_most(Vectors velocity) const {
    const Vectors change = velocity - velocity_mps_;
    const V change_mps = length(change), most = all(kTuning.most_mps2 * p_.period_s);
    const M is_more = hn::And(hn::FirstN(D(), own_.count), change_mps > most);
    if (hn::AllFalse(D(), is_more)) return velocity;
    LanesOfPlanes planes;
    add_walls(walls_, all(kTurned) * radius_m_, p_.wall_horizon_s, planes);
    return select(is_more, choose(planes, is_more, velocity_mps_ + most / change_mps * change),
                  velocity);
  }

  const SteeringView& p_;
  const LanesOfPeople& own_;
  LanesOfWalls walls_;
  Others others_[NeighbourGrid::kMost];
  size_t count_ = 0;
  Vectors way_, velocity_mps_;
  V radius_m_, size_, max_speed_mps_, eagerness_, urge_;
  V wanted_mps_, speed_mps_, openness_;
  M wants_, in_crowd_;
};

}  // namespace
}  // namespace heuristic

void decide_heuristic_all(const SteeringView& people, std::span<const uint32_t> slots,
                          float* next_x_mps, float* next_y_mps) {
  for (size_t first = 0; first < slots.size(); first += kLanes)
    heuristic::Decisions(people, LanesOfPeople(slots, first)).decide(next_x_mps, next_y_mps);
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
