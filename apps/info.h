// What `throng info` prints for each kind of file.
// One rule: each function reads the whole file with the library's own reader and throws InputError
// before it prints anything.
#pragma once

#include <filesystem>
#include <string>

namespace throng {

void print_tri_info(const std::filesystem::path& file);
void print_urdf_info(const std::filesystem::path& file);
/// A scene file, or the name of a bundled scene.
void print_scene_info(const std::string& path_or_name);

}  // namespace throng
