// to_kdl() converts a checked robot to a KDL::Tree. Internal to the folder: keeps KDL out of the
// public headers.
// Segments are named after links and joints after joints. KDL renumbers joints when it copies a
// tree; look them up by name.
#pragma once

#include <kdl/tree.hpp>

#include "kinematics/robot.h"

namespace throng {

/// Mimic joints become independent joints; the caller applies the mimic to a KDL::JntArray.
KDL::Tree to_kdl(const Robot& robot);

}  // namespace throng
