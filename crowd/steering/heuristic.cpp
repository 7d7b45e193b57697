// The heuristic, agent by agent: the definition for the SIMD version.
#include "crowd/steering/heuristic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/portable_math.h"
#include "crowd/steering/heuristic_tuning.h"

namespace throng {
namespace heuristic {
namespace {

constexpr size_t kCandidates = Turns::kCount;
using Values = std::array<float, kCandidates>;

float square(float x) { return x * x; }

/// x / (1 + x^8)^(1/8): x where it is small, 1 where it is large.
float saturated(float x) {
  return x / std::sqrt(std::sqrt(std::sqrt(1 + square(square(square(x))))));
}

/// Bisector of two directions, of which the second is weighted by its length.
Eigen::Vector2f between(const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  const Eigen::Vector2f sum = a + b;
  return sum / std::sqrt(sum.x() * sum.x() + sum.y() * sum.y());
}

/// A neighbour as seen by the deciding agent.
struct Other {
  float x_m, y_m;        ///< relative position
  float vx_mps, vy_mps;  ///< actual velocity
  float ox_mps, oy_mps;  ///< expected velocity
  float direction_x, direction_y;
  float size;        ///< mean of both
  float impatience;  ///< maximum of both
  float square_m2;
};

class Decision {
 public:
  Decision(const SteeringView& people, size_t i, uint32_t slot)
      : p_(people), own_(people.published[slot]), i_(i), slot_(slot) {
    size_ = own_.radius_m / kRadius_m;
    const float wx = own_.preferred_x_mps, wy = own_.preferred_y_mps;
    preferred_mps_ = std::sqrt(wx * wx + wy * wy);
    if (wants_to_move()) {
      direction_x_ = wx / preferred_mps_;
      direction_y_ = wy / preferred_mps_;
    }
    vx_mps_ = own_.vx_mps;
    vy_mps_ = own_.vy_mps;
    speed_mps_ = std::sqrt(vx_mps_ * vx_mps_ + vy_mps_ * vy_mps_);
    first_wall_ = p_.wall_starts[i];
    end_wall_ = p_.wall_starts[i + 1];
    load_neighbours();
  }

  Eigen::Vector2f velocity_mps() const {
    Eigen::Vector2f preferred = Eigen::Vector2f::Zero(), aside = drift();
    if (wants_to_move()) {
      const Eigen::Vector2f direction = best_direction();
      preferred = speed_along(direction) * direction;
      const float along = aside.dot(direction);
      if (along > 0) aside -= along * direction;
    }
    return limit_acceleration(avoid_bodies(approach(preferred + aside)));
  }

 private:
  bool wants_to_move() const { return preferred_mps_ > kMinPreferred_mps; }
  bool is_against(const Other& o) const {
    return direction_x_ * o.direction_x + direction_y_ * o.direction_y < kAgainst;
  }

  void load_neighbours() {
    const uint32_t* near = p_.neighbours + NeighbourGrid::kMaxNeighbours * slot_;
    count_ = p_.neighbour_counts[slot_];
    for (size_t k = 0; k < count_; ++k) {
      const uint32_t other = near[k];
      const NeighbourState& published = p_.published[other];
      Other& o = others_[k];
      o.x_m = published.x_m - own_.x_m;
      o.y_m = published.y_m - own_.y_m;
      o.square_m2 = o.x_m * o.x_m + o.y_m * o.y_m;
      // Agents at one place separate along x, in the order of slots.
      if (o.square_m2 == 0) {
        o.x_m = slot_ < other ? 1e-3f : -1e-3f;
        o.square_m2 = o.x_m * o.x_m;
      }
      o.vx_mps = published.vx_mps;
      o.vy_mps = published.vy_mps;
      o.ox_mps = o.vx_mps + kTuning.preferred_share * (published.preferred_x_mps - o.vx_mps);
      o.oy_mps = o.vy_mps + kTuning.preferred_share * (published.preferred_y_mps - o.vy_mps);
      o.direction_x = published.direction_x;
      o.direction_y = published.direction_y;
      o.size = 0.5f * (size_ + published.radius_m / kRadius_m);
      o.impatience = std::max(own_.impatience, published.impatience);
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
    const float apart_m = wants_to_move() ? walking_apart_m : kTuning.waits_apart_m;
    // An agent without progress closes up.
    const float drift_mps =
        wants_to_move() ? (1 - own_.impatience) * kTuning.drift_mps : kTuning.waits_drift_mps;
    for (size_t k = 0; k < count_; ++k) {
      const Other& o = others_[k];
      const float distance_m = std::sqrt(o.square_m2);
      const float deficit =
          std::clamp((apart_m * o.size - distance_m) / kTuning.drift_m, 0.0f, 2.0f);
      sum -= drift_mps * deficit / distance_m * Eigen::Vector2f(o.x_m, o.y_m);
    }
    for (uint32_t w = first_wall_; w < end_wall_; ++w) {
      const float gap_m = p_.wall_clearance_m[w] + own_.radius_m - kTuning.wall_m;
      const float deficit = std::clamp(1 - gap_m / kTuning.wall_drift_m, 0.0f, 2.0f);
      sum += kTuning.wall_drift_mps * deficit * Eigen::Vector2f(p_.wall_x[w], p_.wall_y[w]);
    }
    return sum + kTuning.side_mps * counterflow() * right_clearance() *
                     Eigen::Vector2f(direction_y_, -direction_x_);
  }

  /// 0 if the wall to the right is near, 1 if it is not.
  float right_clearance() const {
    float clearance = 1;
    for (uint32_t w = first_wall_; w < end_wall_; ++w) {
      const float to_right = direction_x_ * p_.wall_y[w] - direction_y_ * p_.wall_x[w];
      const float gap_m = p_.wall_clearance_m[w] + own_.radius_m - kTuning.side_from_m;
      if (to_right > kRightSine)
        clearance = std::min(clearance, std::clamp(gap_m / kTuning.side_range_m, 0.0f, 1.0f));
    }
    return clearance;
  }

  /// 0 to 1 with the number of oncoming agents; 0 for standing agents.
  float counterflow() const {
    float oncoming = 0;
    for (size_t k = 0; k < count_; ++k)
      if (is_against(others_[k]) &&
          others_[k].x_m * direction_x_ + others_[k].y_m * direction_y_ > 0)
        oncoming += 1;
    return std::min(oncoming / kTuning.oncoming, 1.0f);
  }

  /// Weight of a neighbour. In a crowd an agent that comes from behind avoids by itself.
  float visible_share(const Other& o) const {
    if (count_ <= kSixth) return 1;
    const float cosine = (direction_x_ * o.x_m + direction_y_ * o.y_m) / std::sqrt(o.square_m2);
    return std::clamp((cosine - kSeenFrom) / (kSeenWholly - kSeenFrom), 0.0f, 1.0f);
  }

  /// Free distance in each direction before a neighbour blocks it: `free` over `per`, compared
  /// crosswise.
  /// With the relative velocity, `nearing` is its dot product with the offset and `passing` its
  /// cross product. Both squares together equal that velocity's square times the offset's square.
  /// All terms are multiples of such products, and one direction costs one square root. `before` is
  /// the time between blocking and the closest approach.
  void limit_by_agent(const Other& o, Values& free, Values& per) const {
    const float visible = visible_share(o);
    if (visible <= 0) return;
    const bool same_direction =
        direction_x_ * o.direction_x + direction_y_ * o.direction_y > kSameDirection;
    const float open = same_direction ? 1.0f : openness_;
    const float size = (1 - kTuning.max_passing_compression * o.impatience) * o.size;
    const float blocked_m = (kTuning.blocked_m + open * kTuning.open_blocked_m) * size;
    const float clear_m = (kTuning.clear_m + open * kTuning.open_clear_m) * size;
    const float per_m2 = 1 / o.square_m2;
    const float blocked = square(blocked_m) * per_m2, clear = square(clear_m) * per_m2;
    const float max_weight = visible * per_m2 / preferred_mps_,
                partly = max_weight / (clear - blocked);
    const float min_weight = kMinBlocks * max_weight;
    const float ahead = preferred_mps_ * (o.x_m * direction_x_ + o.y_m * direction_y_);
    const float to_left = preferred_mps_ * (direction_x_ * o.y_m - direction_y_ * o.x_m);
    const float its_nearing = o.x_m * o.ox_mps + o.y_m * o.oy_mps;
    const float its_passing = o.x_m * o.oy_mps - o.y_m * o.ox_mps;
    for (size_t i = 0; i < kCandidates; ++i) {
      const float cos = kTurns.cos[i], sin = kTurns.sin[i];
      const float nearing = cos * ahead - its_nearing + sin * to_left;
      const float passing = sin * ahead - (cos * to_left + its_passing);
      const float miss = passing * passing, both = nearing * nearing + miss;
      const float lacks = clear * both - miss;
      if (nearing <= 0 || lacks <= 0) continue;
      const float before = std::sqrt(std::max(blocked * both - miss, 0.0f));
      const float blocks = std::min(std::max(lacks * partly, min_weight * both), max_weight * both);
      const float free_product = std::max(nearing - before, 0.0f);
      if (!(free_product * per[i] < free[i] * blocks)) continue;
      free[i] = free_product;
      per[i] = blocks;
    }
  }

  /// The preferred direction may lead past walls: a wall blocks directions that lead more into it.
  void limit_by_wall(uint32_t w, const Values& x, const Values& y, Values& free_m) const {
    const float distance_m = p_.wall_clearance_m[w] + own_.radius_m;
    const float clear_m = std::min(kTuning.wall_m * size_, 0.95f * distance_m);
    const float min_weight =
        std::max(-(p_.wall_x[w] * direction_x_ + p_.wall_y[w] * direction_y_), 0.0f) + 1e-3f;
    for (size_t i = 0; i < kCandidates; ++i) {
      const float into = -(p_.wall_x[w] * x[i] + p_.wall_y[w] * y[i]);
      const float miss_square = square(distance_m) * std::max(1 - into * into, 0.0f);
      const float chord_m2 = clear_m * clear_m - miss_square;
      if (into <= min_weight || chord_m2 <= 0) continue;
      free_m[i] = std::min(free_m[i], std::max(distance_m * into - std::sqrt(chord_m2), 0.0f));
    }
  }

  Eigen::Vector2f best_direction() const {
    Values x, y, free_m, per, worth;
    for (size_t i = 0; i < kCandidates; ++i) {
      x[i] = kTurns.cos[i] * direction_x_ - kTurns.sin[i] * direction_y_;
      y[i] = kTurns.cos[i] * direction_y_ + kTurns.sin[i] * direction_x_;
      free_m[i] = kFar_m;
      per[i] = 1;
    }
    for (size_t k = 0; k < count_; ++k) limit_by_agent(others_[k], free_m, per);
    for (size_t i = 0; i < kCandidates; ++i) free_m[i] /= per[i];
    for (uint32_t w = first_wall_; w < end_wall_; ++w) limit_by_wall(w, x, y, free_m);
    const float keep =
        kTuning.inertia * std::min(1 / preferred_mps_, 1 / std::max(speed_mps_, 1e-3f));
    // Sides matter for passing an agent, and not for an agent without progress.
    const float straight_m = free_m[Turns::kStraight];
    const float keep_right = straight_m < kFar_m ? (1 - own_.impatience) *
                                                       (kTuning.keep_right * kTuning.horizon_m) /
                                                       (straight_m + kTuning.horizon_m)
                                                 : 0;
    for (size_t i = 0; i < kCandidates; ++i)
      worth[i] = kTurns.cos[i] * free_m[i] / (free_m[i] + kTuning.horizon_m) +
                 keep * (x[i] * vx_mps_ + y[i] * vy_mps_) -
                 keep_right * std::max(kTurns.sin[i], 0.0f);
    size_t best = Turns::kStraight;
    for (size_t i = 0; i < kCandidates; ++i)
      if (worth[i] > worth[best]) best = i;
    Eigen::Vector2f direction(x[best], y[best]);
    if (best == 0 || best == Turns::kLast) return direction;
    constexpr float kMinBend = 1e-6f;
    const float to_left =
        parabola_minimum(-worth[best - 1], -worth[best], -worth[best + 1], kMinBend);
    if (to_left == 0) return direction;
    const size_t next = to_left > 0 ? best + 1 : best - 1;
    direction += std::abs(to_left) * (Eigen::Vector2f(x[next], y[next]) - direction);
    direction /= std::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
    return direction;
  }

  /// 1 for agents along a direction, 0 for those across or against it.
  static float alignment(const Eigen::Vector2f& direction, const Other& o) {
    const float cosine = direction.x() * o.direction_x + direction.y() * o.direction_y;
    return std::clamp((cosine - kSameDirection) / (kAligned - kSameDirection), 0.0f, 1.0f);
  }

  /// Extension of the gap to an agent at this distance that is faster by this much.
  float gap_growth_m(float ahead_m, float faster_mps) const {
    const float follows = std::clamp(
        (ahead_m - kTuning.touching_m) / (kTuning.follows_m - kTuning.touching_m), 0.0f, 1.0f);
    const float catch_up_s = kTuning.catch_up_s + kTuning.catch_up_s2pm * faster_mps;
    return (kTuning.ahead_s + own_.catch_up * follows * catch_up_s) * faster_mps;
  }

  /// Agents of the same direction are ahead or aside relative to the mean of both directions. Two
  /// that come to a door from its sides walk through it abreast.
  float speed_along(const Eigen::Vector2f& direction) const {
    float gap_m = kFar_m;
    for (size_t k = 0; k < count_; ++k) {
      const Other& o = others_[k];
      const float same = alignment(direction, o);
      const Eigen::Vector2f along =
          between(direction, same * Eigen::Vector2f(o.direction_x, o.direction_y));
      const float ahead_m = o.x_m * along.x() + o.y_m * along.y();
      const float aside_m = std::abs(o.x_m * along.y() - o.y_m * along.x());
      const float other_mps = o.vx_mps * direction.x() + o.vy_mps * direction.y();
      const bool is_met = other_mps < kOncoming_mps || is_against(o);
      const float shoulders_m =
          (is_met ? kTuning.passing_m * (1 - o.impatience) : kTuning.shoulders_m) * o.size;
      if (ahead_m <= 0 || aside_m >= shoulders_m) continue;
      // If two are ahead of one another, the one with the other more directly ahead waits.
      if (same == 0 && -(o.x_m * o.direction_x + o.y_m * o.direction_y) > ahead_m) continue;
      const float round = std::sqrt(std::sqrt(1 - square(square(aside_m / shoulders_m))));
      gap_m = std::min(gap_m,
                       ahead_m - kTuning.stand_m * o.size * round +
                           gap_growth_m(ahead_m / o.size, std::max(other_mps - speed_mps_, 0.0f)));
    }
    return preferred_mps_ * saturated(std::max(gap_m, 0.0f) / kTuning.gap_range_m);
  }

  /// Part of a preferred velocity that can be reached by the next decision. Changes across the
  /// preferred direction are small, because feet have to follow.
  Eigen::Vector2f approach(const Eigen::Vector2f& preferred) const {
    const Eigen::Vector2f now(vx_mps_, vy_mps_);
    const bool slows = preferred.squaredNorm() < now.squaredNorm();
    const float share = p_.period_s / (slows ? kTuning.slow_down_s : kTuning.speed_up_s);
    const Eigen::Vector2f change = std::min(share, 1.0f) * (preferred - now),
                          right(direction_y_, -direction_x_);
    const float max_mps = kTuning.across_mps2 * p_.period_s, to_right_mps = change.dot(right);
    return now + change - (to_right_mps - std::clamp(to_right_mps, -max_mps, max_mps)) * right;
  }

  /// Upper bound of accelerations, except for walls.
  Eigen::Vector2f limit_acceleration(const Eigen::Vector2f& velocity) const {
    const Eigen::Vector2f now(vx_mps_, vy_mps_);
    const Eigen::Vector2f change = velocity - now;
    const float length = change.norm(), max_change = kTuning.max_mps2 * p_.period_s;
    if (length <= max_change) return velocity;
    std::array<HalfPlane, kMaxWalls> walls;
    const size_t count = add_walls(p_, i_, kTurned * own_.radius_m, walls.data());
    return choose_velocity({walls.data(), count}, static_cast<int>(count),
                           now + max_change / length * change, own_.max_speed_mps);
  }

  /// Squared cosine between the offset at the closest approach and a direction, averaged over both
  /// agents: 1 straight ahead or behind, 0 to the side.
  float squared_ahead_cosine(const Other& o) const {
    const float vx = vx_mps_ - o.vx_mps, vy = vy_mps_ - o.vy_mps;
    const float nearest_s =
        std::clamp((o.x_m * vx + o.y_m * vy) / std::max(vx * vx + vy * vy, 1e-4f), 0.0f,
                   kTuning.body_horizon_s);
    const float x = o.x_m - nearest_s * vx, y = o.y_m - nearest_s * vy;
    const float square_m2 = std::max(x * x + y * y, 1e-6f);
    const float own =
        wants_to_move() ? square(x * direction_x_ + y * direction_y_) : 0.5f * square_m2;
    const bool it_stands = o.direction_x == 0 && o.direction_y == 0;
    const float its = it_stands ? 0.5f * square_m2 : square(x * o.direction_x + y * o.direction_y);
    return 0.5f * (own + its) / square_m2;
  }

  /// Velocity nearest to a preferred one that leads into no wall and no body. It is no faster,
  /// because agents behind push no agent forward.
  Eigen::Vector2f avoid_bodies(const Eigen::Vector2f& preferred) const {
    std::array<HalfPlane, kMaxPlanes> planes;
    size_t count = add_walls(p_, i_, kTurned * own_.radius_m, planes.data());
    if (wants_to_move()) {
      const Eigen::Vector2f direction(direction_x_, direction_y_);
      planes[count++] = {-direction, -std::max(direction.dot(preferred), 0.0f)};
    }
    const auto hard = static_cast<int>(count);
    const float body_width_m = kTuning.body_width_m * (1 - kTuning.shoulder_turn * (1 - openness_));
    Encounter e;
    e.own_velocity_mps = {vx_mps_, vy_mps_};
    e.horizon_s = kTuning.body_horizon_s;
    e.step_s = kTuning.body_horizon_s;  // avoids jumps out of an overlap
    for (size_t k = 0; k < count_; ++k) {
      const Other& o = others_[k];
      const float body_m =
          body_width_m + (kTuning.body_depth_m - body_width_m) * squared_ahead_cosine(o);
      e.radius_m = body_m * (1 - kTuning.max_compression * o.impatience) * o.size;
      const float reach_m = e.radius_m + kTuning.body_horizon_s * kMaxApproach_mps;
      if (o.square_m2 > square(reach_m)) break;  // neighbours are sorted by distance
      e.offset_m = {o.x_m, o.y_m};
      e.other_velocity_mps = {o.vx_mps, o.vy_mps};
      planes[count++] = avoidance_plane(e);
    }
    return choose_velocity({planes.data(), count}, hard, preferred, own_.max_speed_mps);
  }

  const SteeringView& p_;
  const NeighbourState& own_;
  size_t i_, slot_;
  float size_ = 1;
  float preferred_mps_ = 0, direction_x_ = 0, direction_y_ = 0;
  float vx_mps_ = 0, vy_mps_ = 0, speed_mps_ = 0;
  float openness_ = 1;  ///< 0 in a dense crowd
  uint32_t first_wall_ = 0, end_wall_ = 0;
  std::array<Other, NeighbourGrid::kMaxNeighbours> others_;
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
