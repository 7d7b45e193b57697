#include "apps/commands/info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/command.h"
#include "apps/options/run_arguments.h"
#include "apps/output/output_plan.h"
#include "apps/output/text_file.h"
#include "avatars/model/describe.h"
#include "base/console.h"
#include "base/errors.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/replay/file_kind.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInfoFooter = R"(
A file whose root element is <robot> is a URDF, under any name. Otherwise the extension chooses the reader:
.tri, .yaml or .yml, .lcmlog. Any other file is read as a recording of people and identified by its content,
see docs/recordings.md.

--plan draws a scene from above before it runs: walkable ground, obstacles, doors, and start areas, goals and
shortest paths of each group. Names without a place are tooltips; a browser shows them.

Examples:
  throng info avatars/models/adult/head.tri
  throng info avatars/models/adult/adult.urdf
  throng info plaza
  throng info plaza --plan plaza.svg
  throng info out/plaza.lcmlog
  throng info experiment.txt --fps 16 --unit cm
  throng info table.csv --columns id=pedID,t=time,x=posX,y=posY)";

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string description_of_scene(const std::string& name) {
  const Scene scene = load_scene(name);
  return describe_scene(scene, navigation_mesh_of(scene));
}

std::string description_of(const std::string& name, const RunOptions& options) {
  const fs::path file(name);
  const std::string extension = is_urdf(file) ? ".urdf" : lower_extension(file);
  std::error_code ignored;
  const bool is_bundled = extension.empty() && !fs::exists(file, ignored);
  if (extension == ".tri" || extension == ".urdf" || extension == ".yaml" || extension == ".yml" ||
      extension == ".lcmlog" || is_bundled)
    require_no_recording_options(options, "a file that needs no options");
  if (extension == ".tri") return describe_tri(read_tri(file), name);
  if (extension == ".urdf") return describe_model(*load_model(file));
  if (extension == ".yaml" || extension == ".yml") return description_of_scene(name);
  if (extension == ".lcmlog") return describe_log(file);
  if (is_bundled) return description_of_scene(name);  // throws with a suggestion if there is none
  const std::optional<FileKind> kind = known_kind(file);
  if (kind && !kind->is_recording)
    throw InputError(name, "a .tri, .urdf, .yaml or .lcmlog file, or a recording", kind->what);
  return describe_recording(*read_recording(recording_options(file, options.recording)), name);
}

/// Describes a scene and draws it.
int describe_and_draw(const std::string& name, const RunOptions& options,
                      const std::string& plan_file) {
  require_no_recording_options(options,
                               "a scene to draw; in a scene file these are keys of 'recording'");
  require_no_other_kind(name);
  const std::string extension = lower_extension(name);
  if (!extension.empty() && extension != ".yaml" && extension != ".yml")
    throw InputError(name, "a scene for --plan, a .yaml file or the name of a bundled scene",
                     fmt::format("a '{}' file", extension));
  OutputPlan outputs;
  outputs.writes({.option = "--plan", .path = plan_file});
  outputs.check();
  const Scene scene = load_scene(name);
  plan_inputs(scene, outputs);
  outputs.check();
  const std::optional<NavMesh> mesh = navigation_mesh_of(scene);
  print_result("{}", describe_scene(scene, mesh));
  write_text(plan_file, draw_plan(scene, mesh));
  print_message("plan: {}\n", plan_file);
  return kExitSuccess;
}

int describe(const std::string& name, const RunOptions& options, const std::string& plan_file) {
  if (!plan_file.empty()) return describe_and_draw(name, options, plan_file);
  print_result("{}", description_of(name, options));
  return kExitSuccess;
}

}  // namespace

Command add_info_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand(
      "info", "Check and describe a .tri mesh, a URDF, a scene, a log or a recording");
  app->footer(kInfoFooter);
  const auto file = std::make_shared<std::string>();
  app->add_option("FILE", *file, "File or bundled scene to describe")->required();
  const auto options = std::make_shared<RunOptions>();
  add_recording_options(*app, *options);
  const auto plan = std::make_shared<std::string>();
  app->add_option("--plan", *plan, "Draw a scene from above into this SVG file")->type_name("FILE");
  return {app, [file, options, plan] { return describe(*file, *options, *plan); }};
}

}  // namespace throng
