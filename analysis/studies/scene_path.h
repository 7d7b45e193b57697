// The way to a value in a scene file: "groups.1.speed_mps.mean".
// One rule: a key that the file does not have is added, for the scene's reader to judge; an item of
// a list has to be there.
#pragma once

#include <string>

#include "scenes/file/yaml_tree.h"

namespace throng {

/// Steps are divided by dots: a key of a map; of a list an item's number, counted from 1, its
/// `name`, or "*" for each. Throws InputError at `where` if a step leads nowhere.
void set_value(YamlNode& root, const std::string& path, const YamlNode& value,
               const std::string& where);

}  // namespace throng
