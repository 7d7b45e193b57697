// Gait files store gaits that were tabulated when Throng was built.
// Invariant: the file name identifies everything its gait depends on (model, style, sources). A
// file that is found equals the gait that would be tabulated, bit by bit. A missing file costs time
// only.
#pragma once

#include <filesystem>

#include "avatars/gait/gait.h"

namespace throng {

/// Reads the gait file built with the program; tabulates the gait if there is none.
Gait gait_of(const Model& model, GaitStyle style);

std::filesystem::path gait_file_name(const Model& model, GaitStyle style);

/// Tabulates a gait and writes its file into the folder. Throws EnvironmentError.
void write_gait_file(const Model& model, GaitStyle style, const std::filesystem::path& folder);

/// Throws InputError for a file that write_gait_file() did not write.
Gait read_gait_file(const std::filesystem::path& file);

}  // namespace throng
