#include "scenes/file/scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "scenes/file/scene_keys.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

fs::path bundled_folder() { return data_directory() / "scenes" / "bundled"; }

}  // namespace

fs::path scene_file(const std::string& path_or_name) {
  fs::path file = path_or_name;
  std::error_code ignored;  // a name too long for a file system names no file
  // A bare word names a bundled scene; a path has a folder or an extension.
  if (!file.has_parent_path() && !file.has_extension() && !fs::exists(file, ignored)) {
    const fs::path bundled = bundled_folder() / (path_or_name + ".yaml");
    if (!fs::exists(bundled, ignored)) {
      std::vector<std::string> names;
      for (const SceneEntry& entry : bundled_scenes()) names.push_back(entry.name);
      throw InputError(path_or_name.empty() ? "scene" : path_or_name,
                       fmt::format("a scene file or a bundled scene ({})", list_of(names)),
                       fmt::format("neither{}", did_you_mean(path_or_name, names)));
    }
    file = bundled;
  }
  return file;
}

Scene load_scene(const std::string& path_or_name) {
  const fs::path file = scene_file(path_or_name);
  const std::string text = read_text_file(file, kMaxYamlBytes);
  return read_scene(file, parse_yaml(text, file.string()));
}

Scene read_scene_text(const std::string& text, const std::string& name) {
  if (text.size() > kMaxYamlBytes)
    throw InputError(name, fmt::format("at most {} bytes", kMaxYamlBytes),
                     fmt::format("{}", text.size()));
  return read_scene(name, parse_yaml(text, name));
}

Goal read_goal_text(const std::string& text, const std::string& name, const Scene& scene) {
  ReadContext context;
  context.scene.name = scene.name;
  context.scene.ground = scene.ground;
  context.scene.floor = scene.floor;
  const YamlNode root = parse_yaml(text, name);
  Fields fields(name, root, goal_keys().title);
  Goal goal;
  read_keys(goal_keys(), context, fields, goal);
  if (goal.is_limited())
    throw InputError(name, "a goal without a queue or capacity", "one with them");
  return goal;
}

std::vector<SceneEntry> bundled_scenes() {
  std::vector<SceneEntry> entries;
  for (const auto& item : fs::directory_iterator(bundled_folder())) {
    if (item.path().extension() != ".yaml") continue;
    const std::string file = item.path().string();
    const YamlNode root = parse_yaml(read_text_file(item.path(), kMaxYamlBytes), file);
    const Fields fields(file, root, "a scene");
    entries.push_back({item.path().stem().string(), fields.line_or("description", "")});
  }
  std::sort(entries.begin(), entries.end(),
            [](const SceneEntry& a, const SceneEntry& b) { return a.name < b.name; });
  return entries;
}

}  // namespace throng
