// The keys of every map that a scene file may hold, for readers, editors and documents.
// One rule: all that is known of a key comes from its row, see key.h.
#pragma once

#include <filesystem>
#include <vector>

#include "scenes/file/key.h"
#include "scenes/file/yaml_tree.h"

namespace throng {

/// Every map, the scene first, with its keys in the order of the documentation.
std::vector<MapText> scene_maps();

/// The file of a scene: a path, or the name of a bundled scene. Throws InputError with a
/// did-you-mean for a name that there is not.
std::filesystem::path scene_file(const std::string& path_or_name);

/// A scene from its tree. Throws InputError.
Scene read_scene(const std::filesystem::path& file, const YamlNode& root);
/// The same with models that were loaded before, by file; adds those that it loads itself.
Scene read_scene(const std::filesystem::path& file, const YamlNode& root, LoadedModels& models);

}  // namespace throng
