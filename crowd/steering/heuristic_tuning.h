// The constants of the heuristic: one set for every scene, fitted to recorded people, see
// docs/validation.md. heuristic.cpp and heuristic_simd.cpp compute with the same.
#pragma once

#include <array>
#include <cstddef>

namespace throng::heuristic {

/// Lengths below are for discs of this radius and grow with it.
inline constexpr float kRadius_m = 0.22f;

/// Lengths are between centres, of people of that radius.
struct Tuning {
  // Speed goes with the gap to who is ahead, which is who is less than shoulders_m aside of the
  // way; at stand_m people stand, from about room_m more on they walk freely.
  float stand_m = 0.667f;
  float shoulders_m = 0.304f;
  float gap_range_m = 0.79f;
  /// Oncoming people pass each other with a shoulder turned.
  float passing_m = 0.26f;
  /// Whoever ahead walks faster will be farther off: the gap is what it will be after so long.
  float ahead_s = 3.8f;
  // Those who are eager count on more, by how much faster the other is and by its square, so that
  // what comes and goes in a queue counts little: nothing if bodies are all but at touching_m, all
  // of it from follows_m on.
  float catch_up_s = 4, catch_up_s2pm = 70, touching_m = 0.3f, follows_m = 0.5f;
  // Nearer than blocked_m to somebody a way is blocked, farther off than clear_m it is free. In the
  // open, and by those who go the same way, people are passed so much farther off; it is open where
  // the sixth nearest is at open_m, and dense where it is at dense_m.
  float blocked_m = 0.28f, clear_m = 0.41f;
  float open_blocked_m = 0.085f, open_clear_m = 0.18f;
  float dense_m = 0.9f, open_m = 1.8f;
  /// From walls.
  float wall_m = 0.23f;
  // Nobody comes nearer than bodies do, within so long: both give way by half (see avoid()). They
  // are wider than deep. Where it is dense shoulders turn: bodies are narrower by this share.
  float body_width_m = 0.46f, body_depth_m = 0.31f, body_horizon_s = 0.55f, shoulder_turn = 0.11f;
  // Of those who get nowhere, and of those whom they meet, bodies become narrower by up to the
  // first share, and the room that they are passed with by up to the second.
  float max_compression = 0.465f, max_passing_compression = 0.24f;
  /// A way that is free for so long is worth half of one that is free for ever.
  float horizon_m = 2;
  /// What turning off costs, and what passing on the left does.
  float inertia = 0.24f;
  float keep_right = 0.12f;
  /// Others are expected to go by so much as they want to, the rest as they do.
  float preferred_share = 0.7f;
  // People drift away from those nearer than apart_m, in the open only from those nearer than
  // open_apart_m, the nearer the faster, and from walls; who gets nowhere closes up, and who waits
  // keeps its place sooner.
  float drift_mps = 0.12f, apart_m = 0.76f, open_apart_m = 0.42f, drift_m = 0.24f;
  float waits_drift_mps = 0.10f, waits_apart_m = 0.50f;
  float wall_drift_mps = 0.25f, wall_drift_m = 0.2f;
  // And to the right, so fast where so many come towards them: each way has its own side then. Not
  // where the wall to the right is at side_from_m, all of it where it is so much farther off.
  float side_mps = 0.27f, oncoming = 2.5f, side_from_m = 0.4f, side_range_m = 0.6f;
  /// Times to take up a velocity, the most that a wish changes it across the way wanted, and the
  /// most that it changes at all.
  float speed_up_s = 0.19f, slow_down_s = 0.35f, across_mps2 = 2.0f, max_mps2 = 3.5f;
};
inline constexpr Tuning kTuning;

/// Whose speed along a way is below this comes towards one; who is slower than the other wants
/// nowhere.
inline constexpr float kOncoming_mps = -0.1f, kMinPreferred_mps = 0.015f;
/// Sine of the angle to the way from which on a wall is to the right.
inline constexpr float kRightSine = 0.5f;
/// Cosine of ways that are against each other.
inline constexpr float kAgainst = -0.5f;
/// Cosines of ways that count as the same, and that do so wholly.
inline constexpr float kSameDirection = 0.3f, kAligned = 0.7f;
/// Whoever has a sixth neighbour is in a crowd, and how far off that is tells how dense it is.
inline constexpr size_t kSixth = 5;
/// Cosines of the angle to the way from which on somebody in a crowd is seen, and wholly.
inline constexpr float kSeenFrom = -0.15f, kSeenWholly = 0.25f;
/// At a wall a shoulder turned is nearer than the disc by this share of its radius.
inline constexpr float kTurned = 0.2f;

/// Whoever is all but far enough off blocks a way by so much: it is a thousand times as long.
inline constexpr float kMinBlocks = 1e-3f;

/// Two who walk towards each other come no nearer than this in a second.
inline constexpr float kMaxApproach_mps = 3;

inline constexpr float kFar_m = 1e3f;

/// The ways that are compared, as turned away from the way wanted, from the right to the left.
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
