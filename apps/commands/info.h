// Descriptions that `throng info` prints of a scene and of a recording.
// Invariant: the library's reader reads the whole file first; there are no partial descriptions.
#pragma once

#include <string>

#include "recordings/recording.h"

namespace throng {

/// Describes a scene file or a bundled scene. Lines end in a line feed. Throws InputError.
std::string describe_scene(const std::string& path_or_name);

/// `file` is the name as the user gave it.
std::string describe_recording(const Recording& recording, const std::string& file);

}  // namespace throng
