// One person after the other: the definition.
#include "crowd/steering/heuristic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.h"
#include "crowd/steering/heuristic_tuning.h"

namespace throng {
namespace heuristic {
namespace {

constexpr size_t kWays = Turns::kCount;
using Values = std::array<float, kWays>;

float square(float x) { return x * x; }

/// x / (1 + x^8)^(1/8): x where it is small, 1 where it is large.
float saturated(float x) {
  return x / std::sqrt(std::sqrt(std::sqrt(1 + square(square(square(x))))));
}

/// The direction in the middle of two, of which the second counts by its length.
Eigen::Vector2f between(const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  const Eigen::Vector2f sum = a + b;
  return sum / std::sqrt(sum.x() * sum.x() + sum.y() * sum.y());
}

/// Somebody else, as seen by the one who decides.
struct Other {
  float x_m, y_m;        ///< from there
  float vx_mps, vy_mps;  ///< as it is
  float ox_mps, oy_mps;  ///< as it is expected
  float way_x, way_y;
  float size;  ///< mean of both
  float urge;  ///< the larger of both
  float square_m2;
};

/// What one person makes of the people and walls around.
class Decision {
 public:
  /// Of the i-th of those who decide.
  Decision(const SteeringView& people, size_t i, uint32_t slot)
      : p_(people), own_(people.seen[slot]), i_(i), slot_(slot) {
    size_ = own_.radius_m / kRadius_m;
    const float wx = own_.wanted_x_mps, wy = own_.wanted_y_mps;
    wanted_mps_ = std::sqrt(wx * wx + wy * wy);
    if (wants()) {
      way_x_ = wx / wanted_mps_;
      way_y_ = wy / wanted_mps_;
    }
    vx_mps_ = own_.vx_mps;
    vy_mps_ = own_.vy_mps;
    speed_mps_ = std::sqrt(vx_mps_ * vx_mps_ + vy_mps_ * vy_mps_);
    first_wall_ = p_.wall_starts[i];
    end_wall_ = p_.wall_starts[i + 1];
    see_others();
  }

  Eigen::Vector2f velocity_mps() const {
    Eigen::Vector2f wish = Eigen::Vector2f::Zero(), aside = drift();
    if (wants()) {
      const Eigen::Vector2f way = best_way();
      wish = speed_on(way) * way;
      // Those behind push nobody forward.
      const float along = aside.dot(way);
      if (along > 0) aside -= along * way;
    }
    return at_most(between_bodies(towards(wish + aside)));
  }

 private:
  bool wants() const { return wanted_mps_ > kWants_mps; }
  bool is_against(const Other& o) const { return way_x_ * o.way_x + way_y_ * o.way_y < kAgainst; }

  void see_others() {
    const uint32_t* near = p_.neighbours + NeighbourGrid::kMost * slot_;
    count_ = p_.neighbour_counts[slot_];
    for (size_t k = 0; k < count_; ++k) {
      const uint32_t other = near[k];
      const Seen& seen = p_.seen[other];
      Other& o = others_[k];
      o.x_m = seen.x_m - own_.x_m;
      o.y_m = seen.y_m - own_.y_m;
      o.square_m2 = o.x_m * o.x_m + o.y_m * o.y_m;
      // Two in one place part along x, each to its own side.
      if (o.square_m2 == 0) {
        o.x_m = slot_ < other ? 1e-3f : -1e-3f;
        o.square_m2 = o.x_m * o.x_m;
      }
      o.vx_mps = seen.vx_mps;
      o.vy_mps = seen.vy_mps;
      o.ox_mps = o.vx_mps + kTuning.intent * (seen.wanted_x_mps - o.vx_mps);
      o.oy_mps = o.vy_mps + kTuning.intent * (seen.wanted_y_mps - o.vy_mps);
      o.way_x = seen.way_x;
      o.way_y = seen.way_y;
      o.size = 0.5f * (size_ + seen.radius_m / kRadius_m);
      o.urge = std::max(own_.urge, seen.urge);
    }
    if (count_ > kSixth)
      openness_ = std::clamp((std::sqrt(others_[kSixth].square_m2) - kTuning.dense_m) /
                                 (kTuning.open_m - kTuning.dense_m),
                             0.0f, 1.0f);
  }

  Eigen::Vector2f drift() const {
    Eigen::Vector2f sum = Eigen::Vector2f::Zero();
    const float walking_apart_m =
        kTuning.apart_m + openness_ * (kTuning.open_apart_m - kTuning.apart_m);
    const float apart_m = wants() ? walking_apart_m : kTuning.waits_apart_m;
    // Whoever gets nowhere closes up.
    const float drift_mps = wants() ? (1 - own_.urge) * kTuning.drift_mps : kTuning.waits_drift_mps;
    for (size_t k = 0; k < count_; ++k) {
      const Other& o = others_[k];
      const float distance_m = std::sqrt(o.square_m2);
      const float lack = std::clamp((apart_m * o.size - distance_m) / kTuning.drift_m, 0.0f, 2.0f);
      sum -= drift_mps * lack / distance_m * Eigen::Vector2f(o.x_m, o.y_m);
    }
    for (uint32_t w = first_wall_; w < end_wall_; ++w) {
      const float gap_m = p_.wall_clearance_m[w] + own_.radius_m - kTuning.wall_m;
      const float lack = std::clamp(1 - gap_m / kTuning.wall_drift_m, 0.0f, 2.0f);
      sum += kTuning.wall_drift_mps * lack * Eigen::Vector2f(p_.wall_x[w], p_.wall_y[w]);
    }
    return sum +
           kTuning.side_mps * counterflow() * room_to_right() * Eigen::Vector2f(way_y_, -way_x_);
  }

  /// 0 where the wall to the right is near, 1 where it is not.
  float room_to_right() const {
    float room = 1;
    for (uint32_t w = first_wall_; w < end_wall_; ++w) {
      const float to_right = way_x_ * p_.wall_y[w] - way_y_ * p_.wall_x[w];
      const float gap_m = p_.wall_clearance_m[w] + own_.radius_m - kTuning.side_from_m;
      if (to_right > kToRight)
        room = std::min(room, std::clamp(gap_m / kTuning.side_room_m, 0.0f, 1.0f));
    }
    return room;
  }

  /// 1 where enough people come towards one, 0 where nobody does, and for those who stand.
  float counterflow() const {
    float oncoming = 0;
    for (size_t k = 0; k < count_; ++k)
      if (is_against(others_[k]) && others_[k].x_m * way_x_ + others_[k].y_m * way_y_ > 0)
        oncoming += 1;
    return std::min(oncoming / kTuning.oncoming, 1.0f);
  }

  /// How much of somebody is made way for. Whoever comes from behind in a crowd keeps clear by
  /// themselves.
  float share_seen(const Other& o) const {
    if (count_ <= kSixth) return 1;
    const float cosine = (way_x_ * o.x_m + way_y_ * o.y_m) / std::sqrt(o.square_m2);
    return std::clamp((cosine - kSeenFrom) / (kSeenWholly - kSeenFrom), 0.0f, 1.0f);
  }

  /// How far one gets on each way before somebody is in it: `free` over `per`, which are compared
  /// crosswise. With the velocity relative to the other, `nearing` is its product with the offset,
  /// `passing` its cross product, and both squares together are that velocity's square times the
  /// offset's. So all is in multiples of such products, and a way costs one root: `before` is how
  /// much sooner than when they are nearest the other blocks the way.
  void keep_clear_of(const Other& o, Values& free, Values& per) const {
    const float seen = share_seen(o);
    if (seen <= 0) return;
    const bool same_way = way_x_ * o.way_x + way_y_ * o.way_y > kSameWay;
    const float open = same_way ? 1.0f : openness_;
    const float size = (1 - kTuning.squeeze_room * o.urge) * o.size;
    const float blocked_m = (kTuning.blocked_m + open * kTuning.open_blocked_m) * size;
    const float clear_m = (kTuning.clear_m + open * kTuning.open_clear_m) * size;
    const float per_m2 = 1 / o.square_m2;
    const float blocked = square(blocked_m) * per_m2, clear = square(clear_m) * per_m2;
    const float most = seen * per_m2 / wanted_mps_, partly = most / (clear - blocked);
    const float least = kLeastBlocks * most;
    const float ahead = wanted_mps_ * (o.x_m * way_x_ + o.y_m * way_y_);
    const float to_left = wanted_mps_ * (way_x_ * o.y_m - way_y_ * o.x_m);
    const float its_nearing = o.x_m * o.ox_mps + o.y_m * o.oy_mps;
    const float its_passing = o.x_m * o.oy_mps - o.y_m * o.ox_mps;
    for (size_t i = 0; i < kWays; ++i) {
      const float cos = kTurns.cos[i], sin = kTurns.sin[i];
      const float nearing = cos * ahead - its_nearing + sin * to_left;
      const float passing = sin * ahead - (cos * to_left + its_passing);
      const float miss = passing * passing, both = nearing * nearing + miss;
      const float lacks = clear * both - miss;
      if (nearing <= 0 || lacks <= 0) continue;
      const float before = std::sqrt(std::max(blocked * both - miss, 0.0f));
      const float blocks = std::min(std::max(lacks * partly, least * both), most * both);
      const float way = std::max(nearing - before, 0.0f);
      if (!(way * per[i] < free[i] * blocks)) continue;
      free[i] = way;
      per[i] = blocks;
    }
  }

  /// The way wanted leads past walls: in the way is one that others lead more into.
  void keep_off_wall(uint32_t w, const Values& x, const Values& y, Values& free_m) const {
    const float distance_m = p_.wall_clearance_m[w] + own_.radius_m;
    const float clear_m = std::min(kTuning.wall_m * size_, 0.95f * distance_m);
    const float least = std::max(-(p_.wall_x[w] * way_x_ + p_.wall_y[w] * way_y_), 0.0f) + 1e-3f;
    for (size_t i = 0; i < kWays; ++i) {
      const float into = -(p_.wall_x[w] * x[i] + p_.wall_y[w] * y[i]);
      const float miss_square = square(distance_m) * std::max(1 - into * into, 0.0f);
      const float room = clear_m * clear_m - miss_square;
      if (into <= least || room <= 0) continue;
      free_m[i] = std::min(free_m[i], std::max(distance_m * into - std::sqrt(room), 0.0f));
    }
  }

  Eigen::Vector2f best_way() const {
    Values x, y, free_m, per, worth;
    for (size_t i = 0; i < kWays; ++i) {
      x[i] = kTurns.cos[i] * way_x_ - kTurns.sin[i] * way_y_;
      y[i] = kTurns.cos[i] * way_y_ + kTurns.sin[i] * way_x_;
      free_m[i] = kFar_m;
      per[i] = 1;
    }
    for (size_t k = 0; k < count_; ++k) keep_clear_of(others_[k], free_m, per);
    for (size_t i = 0; i < kWays; ++i) free_m[i] /= per[i];
    for (uint32_t w = first_wall_; w < end_wall_; ++w) keep_off_wall(w, x, y, free_m);
    const float keep = kTuning.keep_on * std::min(1 / wanted_mps_, 1 / std::max(speed_mps_, 1e-3f));
    // Sides matter when somebody has to be passed, and not to who gets nowhere.
    const float straight_m = free_m[Turns::kStraight];
    const float keep_right = straight_m < kFar_m
                                 ? (1 - own_.urge) * (kTuning.keep_right * kTuning.horizon_m) /
                                       (straight_m + kTuning.horizon_m)
                                 : 0;
    for (size_t i = 0; i < kWays; ++i)
      worth[i] = kTurns.cos[i] * free_m[i] / (free_m[i] + kTuning.horizon_m) +
                 keep * (x[i] * vx_mps_ + y[i] * vy_mps_) -
                 keep_right * std::max(kTurns.sin[i], 0.0f);
    size_t best = Turns::kStraight;
    for (size_t i = 0; i < kWays; ++i)
      if (worth[i] > worth[best]) best = i;
    Eigen::Vector2f way(x[best], y[best]);
    if (best == 0 || best == Turns::kLast) return way;
    constexpr float kLeastBend = 1e-6f;
    const float to_left =
        lowest_between(-worth[best - 1], -worth[best], -worth[best + 1], kLeastBend);
    if (to_left == 0) return way;
    const size_t next = to_left > 0 ? best + 1 : best - 1;
    way += std::abs(to_left) * (Eigen::Vector2f(x[next], y[next]) - way);
    way /= std::sqrt(way.x() * way.x() + way.y() * way.y());
    return way;
  }

  /// 1 of those who go along with a way, 0 of those who go across or against it.
  static float share_of_same_way(const Eigen::Vector2f& way, const Other& o) {
    const float cosine = way.x() * o.way_x + way.y() * o.way_y;
    return std::clamp((cosine - kSameWay) / (kAlong - kSameWay), 0.0f, 1.0f);
  }

  /// How much longer a gap is taken to be to somebody so far ahead who is so much faster.
  float growth_m(float ahead_m, float faster_mps) const {
    const float follows = std::clamp(
        (ahead_m - kTuning.touching_m) / (kTuning.follows_m - kTuning.touching_m), 0.0f, 1.0f);
    const float eager_s = kTuning.eager_s + kTuning.eager_s2pm * faster_mps;
    return (kTuning.ahead_s + own_.eagerness * follows * eager_s) * faster_mps;
  }

  /// Whoever goes the same way is ahead or aside as seen along the mean of both ways: two who come
  /// to a door from its sides walk through it beside each other.
  float speed_on(const Eigen::Vector2f& way) const {
    float gap_m = kFar_m;
    for (size_t k = 0; k < count_; ++k) {
      const Other& o = others_[k];
      const float same = share_of_same_way(way, o);
      const Eigen::Vector2f along = between(way, same * Eigen::Vector2f(o.way_x, o.way_y));
      const float ahead_m = o.x_m * along.x() + o.y_m * along.y();
      const float aside_m = std::abs(o.x_m * along.y() - o.y_m * along.x());
      const float other_mps = o.vx_mps * way.x() + o.vy_mps * way.y();
      const bool is_met = other_mps < kOncoming_mps || is_against(o);
      const float shoulders_m =
          (is_met ? kTuning.passing_m * (1 - o.urge) : kTuning.shoulders_m) * o.size;
      if (ahead_m <= 0 || aside_m >= shoulders_m) continue;
      // Of two who are ahead of one another, the one that has the other more ahead waits.
      if (same == 0 && -(o.x_m * o.way_x + o.y_m * o.way_y) > ahead_m) continue;
      const float round = std::sqrt(std::sqrt(1 - square(square(aside_m / shoulders_m))));
      gap_m =
          std::min(gap_m, ahead_m - kTuning.stand_m * o.size * round +
                              growth_m(ahead_m / o.size, std::max(other_mps - speed_mps_, 0.0f)));
    }
    return wanted_mps_ * saturated(std::max(gap_m, 0.0f) / kTuning.room_m);
  }

  /// What of a wish can be taken up until the next decision: across the way wanted little at once,
  /// as feet have to follow.
  Eigen::Vector2f towards(const Eigen::Vector2f& wish) const {
    const Eigen::Vector2f now(vx_mps_, vy_mps_);
    const bool slows = wish.squaredNorm() < now.squaredNorm();
    const float share = p_.period_s / (slows ? kTuning.slow_down_s : kTuning.speed_up_s);
    const Eigen::Vector2f change = std::min(share, 1.0f) * (wish - now), right(way_y_, -way_x_);
    const float most_mps = kTuning.across_mps2 * p_.period_s, to_right_mps = change.dot(right);
    return now + change - (to_right_mps - std::clamp(to_right_mps, -most_mps, most_mps)) * right;
  }

  /// Nobody changes velocity faster, but for walls.
  Eigen::Vector2f at_most(const Eigen::Vector2f& velocity) const {
    const Eigen::Vector2f now(vx_mps_, vy_mps_);
    const Eigen::Vector2f change = velocity - now;
    const float length = change.norm(), most = kTuning.most_mps2 * p_.period_s;
    if (length <= most) return velocity;
    std::array<HalfPlane, kMostWalls> walls;
    const size_t count = add_walls(p_, i_, kTurned * own_.radius_m, walls.data());
    return choose_velocity({walls.data(), count}, static_cast<int>(count),
                           now + most / length * change, own_.max_speed_mps);
  }

  /// Where another will be when it is nearest: squared cosine of the angle to the ways of both, 1
  /// straight ahead or behind and 0 beside; the mean of both.
  float square_of_ahead(const Other& o) const {
    const float vx = vx_mps_ - o.vx_mps, vy = vy_mps_ - o.vy_mps;
    const float nearest_s = std::clamp(
        (o.x_m * vx + o.y_m * vy) / std::max(vx * vx + vy * vy, 1e-4f), 0.0f, kTuning.body_s);
    const float x = o.x_m - nearest_s * vx, y = o.y_m - nearest_s * vy;
    const float square_m2 = std::max(x * x + y * y, 1e-6f);
    const float own = wants() ? square(x * way_x_ + y * way_y_) : 0.5f * square_m2;
    const bool it_stands = o.way_x == 0 && o.way_y == 0;
    const float its = it_stands ? 0.5f * square_m2 : square(x * o.way_x + y * o.way_y);
    return 0.5f * (own + its) / square_m2;
  }

  /// What is nearest to a wish and leads into no wall and nobody's body, and no farther ahead:
  /// those behind push nobody forward.
  Eigen::Vector2f between_bodies(const Eigen::Vector2f& wish) const {
    std::array<HalfPlane, kMostPlanes> planes;
    size_t count = add_walls(p_, i_, kTurned * own_.radius_m, planes.data());
    if (wants()) {
      const Eigen::Vector2f way(way_x_, way_y_);
      planes[count++] = {-way, -std::max(way.dot(wish), 0.0f)};
    }
    const auto hard = static_cast<int>(count);
    const float wide_m = kTuning.wide_m * (1 - kTuning.turned * (1 - openness_));
    Encounter e;
    e.own_velocity_mps = {vx_mps_, vy_mps_};
    e.horizon_s = kTuning.body_s;
    e.step_s = kTuning.body_s;  // nobody jumps out of an overlap
    for (size_t k = 0; k < count_; ++k) {
      const Other& o = others_[k];
      const float body_m = wide_m + (kTuning.deep_m - wide_m) * square_of_ahead(o);
      e.radius_m = body_m * (1 - kTuning.squeeze * o.urge) * o.size;
      const float reach_m = e.radius_m + kTuning.body_s * kFastest_mps;
      if (o.square_m2 > square(reach_m)) break;  // they come nearest first
      e.offset_m = {o.x_m, o.y_m};
      e.other_velocity_mps = {o.vx_mps, o.vy_mps};
      planes[count++] = avoid(e);
    }
    return choose_velocity({planes.data(), count}, hard, wish, own_.max_speed_mps);
  }

  const SteeringView& p_;
  const Seen& own_;
  size_t i_, slot_;
  float size_ = 1;
  float wanted_mps_ = 0, way_x_ = 0, way_y_ = 0;
  float vx_mps_ = 0, vy_mps_ = 0, speed_mps_ = 0;
  float openness_ = 1;  ///< 0 in a dense crowd
  uint32_t first_wall_ = 0, end_wall_ = 0;
  std::array<Other, NeighbourGrid::kMost> others_;
  size_t count_ = 0;
};

}  // namespace
}  // namespace heuristic

void decide_heuristic_scalar(const SteeringView& people, std::span<const uint32_t> slots,
                             float* next_x_mps, float* next_y_mps) {
  for (size_t i = 0; i < slots.size(); ++i) {
    const Eigen::Vector2f velocity = heuristic::Decision(people, i, slots[i]).velocity_mps();
    next_x_mps[slots[i]] = velocity.x();
    next_y_mps[slots[i]] = velocity.y();
  }
}

}  // namespace throng
