// What `throng info` says about a scene and about a recording.
// One rule: everything is read by the library's own reader first; half a description is none.
#pragma once

#include <string>

#include "recordings/recording.h"

namespace throng {

/// A scene file, or the name of a bundled scene. Lines end in a line feed. Throws InputError.
std::string describe_scene(const std::string& path_or_name);

/// `file`: as it was given.
std::string describe_recording(const Recording& recording, const std::string& file);

}  // namespace throng
