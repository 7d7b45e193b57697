// A checked robot as a KDL::Tree. Internal to the folder: KDL stays behind kinematics' headers.
// One rule: segments are named after links and joints after joints; KDL renumbers joints when a
// tree is copied, so look them up by name.
#pragma once

#include <kdl/tree.hpp>

#include "kinematics/robot.h"

namespace throng {

/// Mimic joints become joints of their own; whoever fills a KDL::JntArray applies the mimic.
KDL::Tree to_kdl(const Robot& robot);

}  // namespace throng
