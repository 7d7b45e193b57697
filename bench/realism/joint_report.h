// The tables of `realism joints`.
// One rule: a row a joint, left and right together.
#pragma once

#include <string>

#include "bench/realism/arm_swing.h"
#include "bench/realism/joint_speeds.h"

namespace throng::realism {

std::string joint_report(const std::string& name, const JointSpeeds& speeds, const ArmSwing& swing);

}  // namespace throng::realism
