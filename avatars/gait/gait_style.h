// StyleParameters describe how a gait style differs from the measured adult.
// Invariant: a style changes postures and strides, but neither path nor speed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace throng {

enum class GaitStyle : uint8_t { kPlain, kRelaxed, kBrisk, kStiff, kPockets, kShortSteps };
inline constexpr size_t kGaitStyleCount = 6;

/// Factors of the measured adult's values; additions in degrees or cycle fractions. kPlain: none.
struct StyleParameters {
  std::string_view name;          ///< name in scene files
  double stride = 1;              ///< factor of the step length; the cadence changes inversely
  double extra_stance = 0;        ///< added to the cycle fraction of stance
  double arm_swing = 1;           ///< factor of the swing of shoulders and elbows
  double shoulder_ahead_deg = 0;  ///< added to the flexion of shoulders
  double elbow_bent_deg = 0;      ///< added to the flexion of elbows
  double arms_out_deg = 0;        ///< added to the abduction of shoulders
  double lean_deg = 0;            ///< forward lean of the trunk while walking
  double sway = 1;                ///< factor of the pelvis's lateral movement and roll
  double twist = 1;               ///< factor of the yaw of pelvis and thorax
  double step_width = 1;
  double toes_out_deg = 0;  ///< added to the yaw of the feet
  double lift = 1;          ///< factor of the height of the swinging foot
};

/// Sources of the values are in gait_style.cpp.
const StyleParameters& parameters_of(GaitStyle style);

}  // namespace throng
