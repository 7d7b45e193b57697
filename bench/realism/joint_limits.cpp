#include "bench/realism/joint_speeds.h"

namespace throng::realism {

// Two kinds of limits stand here.
// Of the upper body, what people do on purpose without haste: a little above what arms and thorax
// do in walking at 1.9 m/s (shoulder 218 degrees/s, elbow 374, thorax 148 by the tables of all
// styles), and for the head what it does in a large shift of gaze (Guitton and Volle 1987).
// Of the legs, what walking itself asks of them. The measured cycle of the adult (OpenSim, 1.45
// m/s; interpolated by its harmonics) has hip, knee and ankle at 212, 366 and 286 degrees/s, at the
// cadence of 1.9 m/s at 243, 419 and 327, and Mentiplay et al. (2018) see speeds of joints grow
// with that of walking, too. The tables go further in all styles, where legs reach for a planted
// foot: up to 441, 798 and 624. Accelerations of the smooth measured cycle are 3000, 7000 and 8700
// degrees/s2; between two frames of 1/60 s the tables have 4 to 9 times that, at heel strike and
// toe-off. So the limits of legs are what plain walking at 0.5 to 1.9 m/s reaches in any style,
// rounded up (`realism joints` without a file): nothing else may be harsher.
const std::vector<JointLimit>& joint_limits() {
  constexpr BodyHalf kLegs = BodyHalf::kLegs, kUpper = BodyHalf::kUpper;
  static const std::vector<JointLimit> limits = {
      {"pelvis_lateral", kLegs, 0.4, 6},         {"pelvis_forward", kLegs, 0.4, 6},
      {"pelvis_vertical", kLegs, 0.4, 8},        {"pelvis_yaw", kLegs, 120, 2000},
      {"pelvis_pitch", kLegs, 100, 2000},        {"pelvis_roll", kLegs, 100, 2000},
      {"hip_flexion", kLegs, 500, 26000},        {"hip_adduction", kLegs, 250, 10000},
      {"hip_rotation", kLegs, 300, 10000},       {"knee_flexion", kLegs, 800, 70000},
      {"ankle_flexion", kLegs, 650, 40000},      {"thorax_yaw", kUpper, 200, 2000},
      {"head_yaw", kUpper, 300, 5000},           {"shoulder_flexion", kUpper, 400, 4000},
      {"shoulder_abduction", kUpper, 300, 4000}, {"elbow_flexion", kUpper, 500, 6000},
      {"wrist_flexion", kUpper, 500, 6000},
  };
  return limits;
}

const JointLimit* limit_of(const std::string& joint) {
  for (const JointLimit& limit : joint_limits())
    if (joint == limit.joint) return &limit;
  return nullptr;
}

}  // namespace throng::realism
