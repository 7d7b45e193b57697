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

/// A scene from its tree. Throws InputError.
Scene read_scene(const std::filesystem::path& file, const YamlNode& root);

}  // namespace throng
