// Quiet standing: breathing, weight shifts from foot to foot, and sway.
// Invariant: a pure function of person and time. The pelvis moves over fixed feet, and stays within
// the gait's bounds at low speed.
//
// Sources: standing people shift their weight in irregular steps from foot to foot and drift little
// in between (Duarte & Zatsiorsky, Motor Control 3, 1999). The body's centre sways sideways by some
// millimetres, mostly below 1 Hz (Winter, Gait & Posture 3, 1995). Adults breathe 12 to 18 times
// per minute. Exact amplitudes and intervals are estimates. Forward sway and chest movement are
// omitted for lack of joints; breathing lifts the arms only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace throng {

struct QuietStanding {
  float shift_m = 0;  ///< pelvis to the left; at most kMaxShift_m to either side
  float breath = 0;   ///< from 0, exhaled, to 1
};

/// Feet stand about 11 cm apart: 5.5 cm would be above one of them.
inline constexpr float kMaxShift_m = 0.045f;
/// Abduction of the arms by a full breath: the chest widens by some millimetres.
inline constexpr float kBreath_rad = 0.01f;
inline constexpr float kStanding_mps = 0.1f;

QuietStanding quiet_standing(uint64_t seed, uint64_t id, double time_s);

/// Advances the time for which a person has stood, limited to kMaxStandingTime_s.
float advance_standing_time(float standing_time_s, bool stands, float step_s);
/// Share of quiet_standing() to apply: 0 in the first second, and soon after setting out.
float standing_share(float standing_time_s);
inline constexpr float kMaxStandingTime_s = 2.5f;

/// Joints for standing, and the share of it that the gait's bounds allow at each speed.
struct StandingJoints {
  int lateral_column = -1;                 ///< column that moves the whole body to the left, or -1
  std::array<int, 2> arm_columns{-1, -1};  ///< columns of shoulder abduction, or -1
  double arms_m = 0;                       ///< maximum distance of a vertex from its shoulder
  std::vector<double> shares;              ///< indexed by speed, from 0 to 1

  double max_shift_m() const { return lateral_column < 0 ? 0.0 : static_cast<double>(kMaxShift_m); }
  /// Returns the maximum displacement of any point of an arm by a breath.
  double max_breath_m() const {
    return arm_columns[0] < 0 ? 0.0 : arms_m * static_cast<double>(kBreath_rad);
  }
};

}  // namespace throng
