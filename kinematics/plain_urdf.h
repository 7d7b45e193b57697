// plain_urdf() writes the URDF that urdfdom is given: what Throng reads of a checked one, and
// nothing else. urdfdom refuses a robot for colours, drives and limits that no pose depends on.
// blank_ignored_tags() blanks what a URDF says to no purpose.
#pragma once

#include <string>
#include <vector>

#include "kinematics/urdf_check.h"
#include "kinematics/xml_scan.h"

namespace throng {

/// Links with the poses and sizes of their shapes, joints with axes, limits and mimics; numbers as
/// the file has them. `use` is what check_urdf() says of `elements`. A capsule is written as a
/// cylinder and a spherical joint as a fixed one, because urdfdom does not know either.
std::string plain_urdf(const std::vector<XmlElement>& elements, const UrdfCheckResult& use);

// What a URDF says to no purpose and urdfdom would refuse: markers without size, inertia that is
// not complete. Robots that people have are full of it. One rule: what is left out is listed; what
// has a surface is never left out.

/// `text` with spaces in place of such tags, so that every line keeps its number. `elements` point
/// into `text`. Adds a line to `notes` for each tag, up to a page.
std::string blank_ignored_tags(const std::string& text, const std::vector<XmlElement>& elements,
                               std::vector<std::string>& notes);

}  // namespace throng
