// Checks that every link of a robot has finite poses, with joints at their upper limits.
#pragma once

#include "kinematics/kinematics.h"

namespace throng {

bool has_finite_poses(const Robot& robot);

}  // namespace throng
