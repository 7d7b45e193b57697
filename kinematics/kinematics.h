// Kinematics: a URDF becomes a checked robot, a KDL tree, and flat arrays that pose many avatars at
// once.
#pragma once

#include "kinematics/flat_model.h"
#include "kinematics/robot.h"
