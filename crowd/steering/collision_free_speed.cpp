#include "crowd/steering/collision_free_speed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "crowd/steering/orca.h"

namespace throng {
namespace {

// The paper's values: strength and range of the repulsion from neighbours, and the time gap.
constexpr float kStrength = 5;
constexpr float kRange_m = 0.1f;
constexpr float kTimeGap_s = 1;

/// Agents within the gap move away from a stuck one at this speed, and none repels it. Addition to
/// the paper, where standing agents have no speed: a waiting crowd would let no agent out.
constexpr float kClearing_mps = 0.5f, kClearingGap_m = 0.3f;

/// Search radius for density; less where the neighbours that fit the list end sooner.
constexpr float kDensityReach_m = 1.5f;

struct Direction {
  float x, y;
};

/// Direction of an agent after repulsion.
struct SteeredDirection {
  Direction direction;
  float clearing_mps;  ///< speed to make room for stuck agents nearby
};

SteeredDirection steer_direction(const SteeringView& p, size_t i, uint32_t slot,
                                 Direction preferred) {
  Direction sum = preferred;
  float max_impatience = 0;
  const auto push = [&](float away_x, float away_y, float gap_m, float share) {
    // Deeper than a disc's radius the exponential would dominate all other terms.
    const float strength =
        share * kStrength *
        (gap_m > 0 ? decaying_exp(gap_m / kRange_m) : 1 + std::min(-gap_m / kRange_m, 3.0f));
    sum.x += strength * away_x;
    sum.y += strength * away_y;
  };
  const NeighbourState& own = p.published[slot];
  for (size_t k = 0; k < p.neighbour_counts[slot]; ++k) {
    const uint32_t other = p.neighbours[NeighbourGrid::kMaxNeighbours * slot + k];
    const NeighbourState& published = p.published[other];
    const float dx = own.x_m - published.x_m;
    const float dy = own.y_m - published.y_m;
    const float distance_m = std::sqrt(dx * dx + dy * dy);
    const float gap_m = distance_m - (own.radius_m + published.radius_m);
    const float share = 2 * avoidance_share(own.impatience, published.impatience);
    if (gap_m < kClearingGap_m)
      max_impatience = std::max(max_impatience, published.impatience - own.impatience);
    if (distance_m > 0)
      push(dx / distance_m, dy / distance_m, gap_m, share);
    else
      push(slot < other ? -1.0f : 1.0f, 0, gap_m, share);
  }
  // Walls only turn aside, never back: posts of a narrow opening would let no agent in.
  const Direction among_people = sum;
  for (uint32_t w = p.wall_starts[i]; w < p.wall_starts[i + 1]; ++w)
    push(p.wall_x[w], p.wall_y[w], p.wall_clearance_m[w], 1);
  const float back = std::min(
      0.0f, (sum.x - among_people.x) * preferred.x + (sum.y - among_people.y) * preferred.y);
  sum.x -= back * preferred.x;
  sum.y -= back * preferred.y;
  const float length = std::sqrt(sum.x * sum.x + sum.y * sum.y);
  if (length > kTiny_mps) preferred = {sum.x / length, sum.y / length};
  return {preferred, max_impatience * kClearing_mps};
}

/// Gap between the discs of an agent and the nearest one in its way along `direction`.
float gap_ahead_m(const SteeringView& p, size_t slot, Direction direction) {
  const NeighbourState& own = p.published[slot];
  float gap_m = 1e9f;
  for (size_t k = 0; k < p.neighbour_counts[slot]; ++k) {
    const NeighbourState& other =
        p.published[p.neighbours[NeighbourGrid::kMaxNeighbours * slot + k]];
    const float dx = other.x_m - own.x_m;
    const float dy = other.y_m - own.y_m;
    const float radius_m = own.radius_m + other.radius_m;
    const float ahead = dx * direction.x + dy * direction.y;
    const float aside = dx * direction.y - dy * direction.x;
    if (ahead < 0 || std::abs(aside) > radius_m) continue;
    gap_m = std::min(gap_m, std::sqrt(dx * dx + dy * dy) - radius_m);
  }
  return gap_m;
}

}  // namespace

float decaying_exp(float x) {
  // (1 - y + y^2/2)^256 with y = x/256.
  const double y = std::min(static_cast<double>(x), 200.0) / 256;
  double power = 1 - y + 0.5 * y * y;
  for (int i = 0; i < 8; ++i) power *= power;
  return static_cast<float>(power);
}

float weidmann_share(float people_per_m2) {
  constexpr float kSteepness = 1.913f, kJam_per_m2 = 5.4f;
  if (people_per_m2 >= kJam_per_m2) return 0;
  const float free_area_m2 = 1 / std::max(people_per_m2, 0.01f) - 1 / kJam_per_m2;
  return 1 - decaying_exp(kSteepness * free_area_m2);
}

float density_ahead(const SteeringView& p, size_t i, uint32_t slot, float direction_x,
                    float direction_y) {
  const NeighbourState& own = p.published[slot];
  const size_t count = p.neighbour_counts[slot];
  const uint32_t* near = p.neighbours + NeighbourGrid::kMaxNeighbours * slot;
  const auto square = [&](uint32_t other) {
    const float dx = p.published[other].x_m - own.x_m;
    const float dy = p.published[other].y_m - own.y_m;
    return dx * dx + dy * dy;
  };
  float reach_square = kDensityReach_m * kDensityReach_m;
  if (count == NeighbourGrid::kMaxNeighbours)
    reach_square = std::min(reach_square, square(near[count - 1]));
  float people = 0.5f;  // half of the agent itself is ahead
  for (size_t k = 0; k < count; ++k) {
    const float dx = p.published[near[k]].x_m - own.x_m;
    const float dy = p.published[near[k]].y_m - own.y_m;
    if (dx * direction_x + dy * direction_y <= 0) continue;
    const float at = square(near[k]);
    // Half of the farthest neighbour, whose distance is the search radius, lies within.
    people += at < reach_square ? 1.0f : (at == reach_square ? 0.5f : 0.0f);
  }
  // Share of the half-disc that is not behind a wall, by points of equal area.
  static constexpr std::array<std::array<float, 2>, 12> kPoints{{{0.96f, 0.13f},
                                                                 {0.96f, -0.13f},
                                                                 {0.8f, 0.5f},
                                                                 {0.8f, -0.5f},
                                                                 {0.45f, 0.83f},
                                                                 {0.45f, -0.83f},
                                                                 {0.6f, 0.15f},
                                                                 {0.6f, -0.15f},
                                                                 {0.3f, 0.5f},
                                                                 {0.3f, -0.5f},
                                                                 {0.12f, 0.85f},
                                                                 {0.12f, -0.85f}}};
  const float reach_m = std::sqrt(reach_square);
  int open = 0;
  for (const auto& [ahead, aside] : kPoints) {
    const float x = reach_m * (ahead * direction_x - aside * direction_y);
    const float y = reach_m * (ahead * direction_y + aside * direction_x);
    bool behind = false;
    for (uint32_t w = p.wall_starts[i]; w < p.wall_starts[i + 1]; ++w)
      behind =
          behind || p.wall_x[w] * x + p.wall_y[w] * y < -(p.wall_clearance_m[w] + own.radius_m);
    open += behind ? 0 : 1;
  }
  const float area_m2 =
      1.5707963f * reach_square * static_cast<float>(std::max(open, 2)) / kPoints.size();
  return people / area_m2;
}

void decide_collision_free_speed(const SteeringView& p, std::span<const uint32_t> slots,
                                 float* next_x_mps, float* next_y_mps) {
  std::array<HalfPlane, kMaxWalls> planes;
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    const NeighbourState& own = p.published[slot];
    const float wx = own.preferred_x_mps, wy = own.preferred_y_mps;
    const float preferred_speed = std::sqrt(wx * wx + wy * wy);
    Direction preferred{0, 0};
    if (preferred_speed > kTiny_mps) preferred = {wx / preferred_speed, wy / preferred_speed};
    const auto [direction, clearing_mps] = steer_direction(p, i, slot, preferred);
    const float max_mps = std::max(preferred_speed, clearing_mps);
    const float speed =
        std::min(max_mps, std::max(0.0f, gap_ahead_m(p, slot, direction) / kTimeGap_s));
    const size_t walls = add_walls(p, i, 0, planes.data());
    const Eigen::Vector2f v =
        choose_velocity({planes.data(), walls}, static_cast<int>(walls),
                        {speed * direction.x, speed * direction.y}, own.max_speed_mps);
    next_x_mps[slot] = v.x();
    next_y_mps[slot] = v.y();
  }
}

}  // namespace throng
