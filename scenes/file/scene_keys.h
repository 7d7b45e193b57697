// Scene keys are the maps and keys of scene files, for readers, editors and documentation.
#pragma once

#include <filesystem>
#include <vector>

#include "scenes/file/key.h"
#include "scenes/file/yaml_tree.h"

namespace throng {

/// All maps, the scene first, with keys in the order of the documentation.
std::vector<MapText> scene_maps();

/// File of a scene, by path or by the name of a bundled scene. Throws InputError with suggestions
/// for an unknown name.
std::filesystem::path scene_file(const std::string& path_or_name);

/// Throws InputError.
Scene read_scene(const std::filesystem::path& file, const YamlNode& root);
/// Reuses `models` loaded earlier, by file, and adds the models that it loads.
Scene read_scene(const std::filesystem::path& file, const YamlNode& root, LoadedModels& models);

}  // namespace throng
