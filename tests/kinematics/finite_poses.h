// What a robot read from any bytes has to do: pose without a number that is none.
// One rule: every link is posed, every joint at the upper end of its range.
#pragma once

#include "kinematics/kinematics.h"

namespace throng {

bool has_finite_poses(const Robot& robot);

}  // namespace throng
