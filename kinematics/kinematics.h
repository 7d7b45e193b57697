// Public header of the folder: checked robots from URDFs, and flat arrays that pose avatars.
#pragma once

#include "base/errors.h"
#include "kinematics/flat_model.h"
#include "kinematics/robot.h"
