// Quiet standing: breathing, shifts of weight from foot to foot, sway.
// One rule: a pure function of who stands and when; it moves the pelvis over feet that stay where
// they are, by so little that the bounds of the gait at low speed hold it.
//
// Sources: people who stand for minutes shift their weight in steps from one foot to the other,
// irregularly, and drift little in between (Duarte & Zatsiorsky, Motor Control 3, 1999); the body's
// centre sways sideways by some millimetres, mostly below 1 Hz (Winter, Gait & Posture 3, 1995);
// adults breathe 12 to 18 times a minute. How far and how often exactly is our own estimate. The
// root has no joint for sway to and fro and the trunk none for the chest: the first is not shown,
// of breathing the arms that the chest lifts.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace throng {

/// What standing adds to a body of scale 1.
struct QuietStanding {
  float shift_m = 0;  ///< of the pelvis, to the left; at most kMaxShift_m to either side
  float breath = 0;   ///< from 0, breathed out, to 1
};

/// Feet stand some 11 cm apart: above one of them would be 5.5 cm.
inline constexpr float kMaxShift_m = 0.045f;
/// How far arms are lifted sideways by a whole breath: the chest widens by some millimetres.
inline constexpr float kBreath_rad = 0.01f;
/// Whoever is slower stands.
inline constexpr float kStanding_mps = 0.1f;

QuietStanding quiet_standing(uint64_t seed, uint64_t id, double time_s);

/// Kept of somebody: for how long it has stood, no more than matters.
float advance_standing_time(float standing_time_s, bool stands, float step_s);
/// How much of quiet_standing() it shows: nothing in the first second, and nothing soon after it
/// has set out.
float standing_share(float standing_time_s);
/// The most that is kept.
inline constexpr float kMaxStandingTime_s = 2.5f;

/// What a model has for standing, and how much of it each speed of its gait's table leaves room
/// for.
struct StandingJoints {
  int lateral_column = -1;                 ///< moves all of the body to the left; -1: none does
  std::array<int, 2> arm_columns{-1, -1};  ///< lift an arm sideways
  double arms_m = 0;                       ///< nothing is farther from the shoulder it hangs from
  std::vector<double> shares;              ///< by speed, from 0 to 1

  double max_shift_m() const { return lateral_column < 0 ? 0.0 : static_cast<double>(kMaxShift_m); }
  /// Nothing of an arm is moved farther by a breath.
  double max_breath_m() const {
    return arm_columns[0] < 0 ? 0.0 : arms_m * static_cast<double>(kBreath_rad);
  }
};

}  // namespace throng
