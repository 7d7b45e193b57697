// Ways of walking: how a style differs from the measured adult.
// One rule: a style changes postures and strides, never where somebody goes or how fast.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace throng {

enum class GaitStyle : uint8_t { kPlain, kRelaxed, kBrisk, kStiff, kPockets, kShortSteps };
inline constexpr size_t kGaitStyleCount = 6;

/// What is multiplied is a share of the measured adult's, what is added is in degrees or in parts
/// of the cycle. kPlain changes nothing.
struct StyleParameters {
  std::string_view name;          ///< in scene files
  double stride = 1;              ///< length of a step; the cadence is the inverse
  double extra_stance = 0;        ///< cycle fraction that a foot is longer on the ground
  double arm_swing = 1;           ///< of shoulders and elbows
  double shoulder_ahead_deg = 0;  ///< added to the flexion of shoulders
  double elbow_bent_deg = 0;      ///< added to the flexion of elbows
  double arms_out_deg = 0;        ///< added to the abduction of shoulders
  double lean_deg = 0;            ///< of the trunk, forward, while walking
  double sway = 1;                ///< of the pelvis to the side and about the line of travel
  double twist = 1;               ///< of pelvis and thorax about the vertical
  double step_width = 1;
  double toes_out_deg = 0;  ///< added to the turn of the feet
  double lift = 1;          ///< of the swinging foot
};

/// Where a figure has a source, gait_style.cpp names it.
const StyleParameters& parameters_of(GaitStyle style);

}  // namespace throng
