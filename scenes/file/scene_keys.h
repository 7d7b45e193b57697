// The keys of every map that a scene file may hold.
// One rule: the reader takes its keys from here and editors theirs from scene.schema.json; a test
// holds the two together.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace throng {

/// Names of maps ("scene", "group", ...) and their keys, in the order of the documentation.
const std::vector<std::pair<std::string_view, std::vector<std::string>>>& scene_keys();

/// The keys of one map. Asserts that there is one of that name.
const std::vector<std::string>& keys_of(std::string_view map);

}  // namespace throng
