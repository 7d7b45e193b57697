// Gaits in files: what was tabulated when Throng was built is read when it starts.
// One rule: a file is named after all that its gait depends on (model, style, our own sources), so
// one that is found is the gait that would be tabulated, bit by bit; without it only time is lost.
#pragma once

#include <filesystem>

#include "avatars/gait/gait.h"

namespace throng {

/// Read from the file that was made with the program, or tabulated where there is none, as for
/// models that do not come with Throng.
Gait gait_of(const Model& model, GaitStyle style);

/// Of a gait's file, without a folder.
std::filesystem::path gait_file_name(const Model& model, GaitStyle style);

/// Tabulates a gait and writes its file into the folder. Throws EnvironmentError.
void write_gait_file(const Model& model, GaitStyle style, const std::filesystem::path& folder);

/// Throws InputError for a file that is not what write_gait_file() wrote.
Gait read_gait_file(const std::filesystem::path& file);

}  // namespace throng
