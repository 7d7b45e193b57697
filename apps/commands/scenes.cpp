#include <fmt/format.h>

#include <algorithm>

#include "apps/command.h"
#include "base/say.h"
#include "scenes/file/scene.h"

namespace throng {

Command add_scenes_command(CLI::App& parent) {
  CLI::App* app = parent.add_subcommand("scenes", "The bundled scenes, a line each");
  const auto action = [] {
    const std::vector<SceneEntry> scenes = bundled_scenes();
    size_t width = 0;
    for (const SceneEntry& scene : scenes) width = std::max(width, scene.name.size());
    for (const SceneEntry& scene : scenes)
      show("{:<{}}  {}\n", scene.name, width, scene.description);
    return kExitFine;
  };
  return {app, action};
}

}  // namespace throng
