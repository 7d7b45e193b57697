#include "avatars/gait/gait_style.h"

namespace throng {
namespace {

// Plain is Boulic's adult with measured changes (gait_curves.cpp). Short steps: at equal speed the
// elderly shorten steps by an eighth or more, prolong double stance and move arms and pelvis less.
// Source: Winter, Patla, Frank & Walt, "Biomechanical walking pattern changes in the fit and
// healthy elderly", Physical Therapy 70, 1990. The other styles are set by eye on pictures of the
// body. Relaxed rolls and leans back, brisk leans forward with bent arms, stiff keeps trunk and
// arms still, pockets keeps the hands at the hips.
constexpr std::array<StyleParameters, kGaitStyleCount> kFigures = {{
    {.name = "plain"},
    {.name = "relaxed",
     .stride = 0.98,
     .extra_stance = 0.01,
     .arm_swing = 1.15,
     .shoulder_ahead_deg = -2,
     .lean_deg = -1.5,
     .sway = 1.3,
     .twist = 1.2,
     .toes_out_deg = 4},
    {.name = "brisk",
     .stride = 1.01,
     .arm_swing = 1.1,
     .elbow_bent_deg = 12,
     .lean_deg = 3.5,
     .sway = 0.8,
     .twist = 1.2,
     .toes_out_deg = -2,
     .lift = 1.15},
    {.name = "stiff",
     .stride = 0.96,
     .arm_swing = 0.4,
     .arms_out_deg = 1,
     .sway = 0.4,
     .twist = 0.4},
    {.name = "pockets",
     .stride = 0.97,
     .arm_swing = 0.12,
     .shoulder_ahead_deg = -17,
     .elbow_bent_deg = 34,
     .arms_out_deg = 3,
     .lean_deg = 1,
     .sway = 1.2,
     .twist = 0.7,
     .toes_out_deg = 2},
    {.name = "short_steps",
     .stride = 0.84,
     .extra_stance = 0.025,
     .arm_swing = 0.6,
     .elbow_bent_deg = 14,
     .arms_out_deg = 2,
     .lean_deg = 5,
     .sway = 1.1,
     .twist = 0.6,
     .step_width = 1.3,
     .toes_out_deg = 4,
     .lift = 0.8},
}};

}  // namespace

const StyleParameters& parameters_of(GaitStyle style) {
  return kFigures[static_cast<size_t>(style)];
}

}  // namespace throng
