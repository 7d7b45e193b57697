// unused_in_urdf() lists the tags of a URDF that Throng makes no use of, or does not know.
#pragma once

#include <string>
#include <vector>

#include "kinematics/xml_scan.h"

namespace throng {

/// Aggregated by tag, a line each.
std::vector<std::string> unused_in_urdf(const std::vector<XmlElement>& elements);

}  // namespace throng
