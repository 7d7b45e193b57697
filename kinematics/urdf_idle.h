// What a URDF says to no purpose and urdfdom would refuse: markers without size, inertia that is
// not complete. Robots that people have are full of it. One rule: what is left out is listed; what
// has a surface is never left out.
#pragma once

#include <string>
#include <vector>

#include "kinematics/xml_scan.h"

namespace throng {

/// `text` with spaces in place of such tags, so that every line keeps its number. `elements` point
/// into `text`. Adds a line to `notes` for each tag, up to a page.
std::string without_idle(const std::string& text, const std::vector<XmlElement>& elements,
                         std::vector<std::string>& notes);

}  // namespace throng
