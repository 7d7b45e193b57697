// The heuristic's constants: one set for all scenes, fitted to recorded people
// (docs/validation.md). heuristic.cpp and heuristic_simd.cpp share them.
#pragma once

#include <array>
#include <cstddef>

namespace throng::heuristic {

/// Lengths below are for discs of this radius and scale with it.
inline constexpr float kRadius_m = 0.22f;

/// Lengths are between centres, for agents of that radius.
struct Tuning {
  // Speed depends on the gap to the agent ahead that is less than shoulders_m to the side. Agents
  // stand at stand_m and walk freely from about gap_range_m more.
  float stand_m = 0.667f;
  float shoulders_m = 0.304f;
  float gap_range_m = 0.79f;
  /// Oncoming agents pass with a shoulder turned.
  float passing_m = 0.26f;
  /// Look-ahead for the gap: a faster agent ahead will be farther away.
  float ahead_s = 3.8f;
  // Catch-up lengthens the gap by the other's excess speed and by its square, which weights small
  // fluctuations in a queue little. None with bodies close to touching_m, full from follows_m on.
  float catch_up_s = 4, catch_up_s2pm = 70, touching_m = 0.3f, follows_m = 0.5f;
  // A direction is blocked within blocked_m of a neighbour and free beyond clear_m. The open_
  // values are added in the open and between agents of the same direction.
  // The distance of the sixth neighbour decides: open at open_m, dense at dense_m.
  float blocked_m = 0.28f, clear_m = 0.41f;
  float open_blocked_m = 0.085f, open_clear_m = 0.18f;
  float dense_m = 0.9f, open_m = 1.8f;
  /// Distance to walls.
  float wall_m = 0.23f;
  // Least distances of bodies within the horizon, wider than deep; both agents avoid by half (see
  // avoidance_plane()). In dense crowds shoulders turn: bodies are narrower by shoulder_turn.
  float body_width_m = 0.46f, body_depth_m = 0.31f, body_horizon_s = 0.55f, shoulder_turn = 0.11f;
  // Shares by which bodies and passing distances shrink around agents without progress.
  float max_compression = 0.465f, max_passing_compression = 0.24f;
  /// A direction with this free distance is worth half of an unlimited one.
  float horizon_m = 2;
  /// Cost of turning off, and of passing on the left.
  float inertia = 0.24f;
  float keep_right = 0.12f;
  /// Share of the preferred velocity in the velocity expected of others.
  float preferred_share = 0.7f;
  // Drift away from neighbours closer than apart_m (open_apart_m in the open) and from walls,
  // faster the closer they are.
  // Agents without progress close up; waiting ones keep their places sooner.
  float drift_mps = 0.12f, apart_m = 0.76f, open_apart_m = 0.42f, drift_m = 0.24f;
  float waits_drift_mps = 0.10f, waits_apart_m = 0.50f;
  float wall_drift_mps = 0.25f, wall_drift_m = 0.2f;
  // Drift to the right at this speed with this many oncoming agents: each direction then has its
  // own side. None with a wall side_from_m to the right, full with one side_range_m farther off.
  float side_mps = 0.27f, oncoming = 2.5f, side_from_m = 0.4f, side_range_m = 0.6f;
  /// Relaxation times of a velocity; maximum acceleration sideways, and in total.
  float speed_up_s = 0.19f, slow_down_s = 0.35f, across_mps2 = 2.0f, max_mps2 = 3.5f;
};
inline constexpr Tuning kTuning;

/// Upper bounds: speed of oncoming agents along a direction; preferred speed that counts as zero.
inline constexpr float kOncoming_mps = -0.1f, kMinPreferred_mps = 0.015f;
/// Sine of the angle to the direction from which on a wall is to the right.
inline constexpr float kRightSine = 0.5f;
/// Cosine of opposite directions.
inline constexpr float kAgainst = -0.5f;
/// Cosines from which on directions count as the same, in part and fully.
inline constexpr float kSameDirection = 0.3f, kAligned = 0.7f;
/// Index of the sixth neighbour: its distance measures density; without it there is no crowd.
inline constexpr size_t kSixth = 5;
/// Cosines of the angle from which on an agent in a crowd is seen, in part and fully.
inline constexpr float kSeenFrom = -0.15f, kSeenWholly = 0.25f;
/// Share of the radius by which a turned shoulder is closer to a wall than the disc.
inline constexpr float kTurned = 0.2f;

/// Least weight of a neighbour that blocks a direction: free distances grow at most a thousandfold.
inline constexpr float kMinBlocks = 1e-3f;

/// Upper bound of approach speeds.
inline constexpr float kMaxApproach_mps = 3;

inline constexpr float kFar_m = 1e3f;

/// Compared directions, as angles from the preferred one, from right to left.
struct Turns {
  static constexpr size_t kCount = 15, kLast = kCount - 1, kStraight = kCount / 2;
  std::array<float, kCount> cos{}, sin{};
};
inline constexpr Turns kTurns = [] {
  // Of 0, 7, 15, 24, 35, 48, 65 and 85 degrees.
  constexpr std::array<float, 8> kCos = {1,           0.99254615f, 0.96592583f, 0.91354546f,
                                         0.81915204f, 0.66913061f, 0.42261826f, 0.08715574f};
  constexpr std::array<float, 8> kSin = {0,           0.12186934f, 0.25881905f, 0.40673664f,
                                         0.57357644f, 0.74314483f, 0.90630779f, 0.99619470f};
  Turns turns;
  for (size_t candidate = 0; candidate < Turns::kCount; ++candidate) {
    const bool to_right = candidate < Turns::kStraight;
    const size_t turn = to_right ? Turns::kStraight - candidate : candidate - Turns::kStraight;
    turns.cos[candidate] = kCos[turn];
    turns.sin[candidate] = to_right ? -kSin[turn] : kSin[turn];
  }
  return turns;
}();

}  // namespace throng::heuristic
