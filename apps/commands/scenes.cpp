#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/output/scene_schema.h"
#include "base/say.h"
#include "scenes/file/scene.h"

namespace throng {

Command add_scenes_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand("scenes", "The bundled scenes, a line each");
  const auto schema = std::make_shared<bool>(false);
  app->add_flag("--schema", *schema,
                "What a scene file may hold instead, as JSON Schema: for editors");
  const auto action = [schema] {
    if (*schema) {
      show("{}\n", scene_schema().dump(2));
      return kExitFine;
    }
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
