// plain_urdf() writes the URDF that urdfdom is given: what Throng reads of a checked one, and
// nothing else. urdfdom refuses a robot for colours, drives and limits that no pose depends on.
#pragma once

#include <string>
#include <vector>

#include "kinematics/urdf_check.h"
#include "kinematics/xml_scan.h"

namespace throng {

/// Links with the poses and sizes of their shapes, joints with axes, limits and mimics; numbers as
/// the file has them. `use` is what check_urdf() says of `elements`. A capsule is written as a
/// cylinder and a spherical joint as a fixed one, because urdfdom does not know either.
std::string plain_urdf(const std::vector<XmlElement>& elements, const UrdfUse& use);

}  // namespace throng
