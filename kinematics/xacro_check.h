// refuse_xacro() finds what is still to be expanded in a URDF: xacro is a language of macros for
// such files, and its program makes plain ones of them.
#pragma once

#include <string>
#include <vector>

#include "kinematics/xml_scan.h"

namespace throng {

/// Throws InputError "file:line: ..." at the first tag of xacro, and at the first `${...}` or
/// `$(...)` in what links and joints consist of: extensions may use those otherwise.
void refuse_xacro(const std::vector<XmlElement>& elements, const std::string& file);

}  // namespace throng
