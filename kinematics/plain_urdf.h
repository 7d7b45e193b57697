// plain_urdf() writes the URDF passed to urdfdom: the parts of a checked URDF that Throng reads.
// urdfdom rejects a robot for colours, drives and limits that no pose depends on.
// blank_ignored_tags() blanks tags that have no effect.
#pragma once

#include <string>
#include <vector>

#include "kinematics/urdf_check.h"
#include "kinematics/xml_scan.h"

namespace throng {

/// Returns links with poses and sizes of their shapes, joints with axes, limits and mimics; numbers
/// as in the file. `use` is the result of check_urdf() for `elements`. A capsule becomes a cylinder
/// and a spherical joint a fixed one, because urdfdom knows neither.
std::string plain_urdf(const std::vector<XmlElement>& elements, const UrdfCheckResult& use);

// Tags without effect that urdfdom would reject: shapes of size zero, incomplete inertia. Published
// robots contain many of them.
// Invariant: every ignored tag is listed, and no tag with a surface is ignored.

/// Returns `text` with spaces in place of such tags, which preserves line numbers. `elements` point
/// into `text`. Appends a line to `notes` for each tag, up to a page.
std::string blank_ignored_tags(const std::string& text, const std::vector<XmlElement>& elements,
                               std::vector<std::string>& notes);

}  // namespace throng
