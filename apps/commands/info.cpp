#include "apps/commands/info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "avatars/model/describe.h"
#include "base/errors.h"
#include "base/say.h"
#include "lcmtypes/log/log_check.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(
The reader is chosen by the extension: .tri, .urdf, .yaml or .yml, .lcmlog.

Examples:
  throng info avatars/models/adult/head.tri
  throng info avatars/models/adult/adult.urdf
  throng info plaza
  throng info out/plaza.lcmlog)";

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

int describe(const std::string& name) {
  const fs::path file(name);
  const std::string extension = lower_extension(file);
  std::string text;
  if (extension == ".tri") {
    text = describe_tri(read_tri(file), name);
  } else if (extension == ".urdf") {
    text = describe_model(*load_model(file));
  } else if (extension == ".yaml" || extension == ".yml") {
    text = describe_scene(name);
  } else if (extension == ".lcmlog") {
    text = describe_log(file);
  } else if (extension.empty() && !fs::exists(file)) {
    text = describe_scene(name);  // a bundled one, or a did-you-mean
  } else {
    throw InputError(name, "a .tri, .urdf, .yaml or .lcmlog file",
                     fs::is_directory(file) ? "a folder"
                     : extension.empty()    ? "no extension"
                                            : "extension '" + extension + "'");
  }
  show("{}", text);
  return kExitFine;
}

}  // namespace

Command add_info_command(CommandLine& parent) {
  CommandOptions* app =
      parent.add_subcommand("info", "Checks and describes a .tri mesh, a URDF, a scene or a log");
  app->footer(kFooter);
  const auto file = std::make_shared<std::string>();
  app->add_option("FILE", *file, "What to describe")->required();
  return {app, [file] { return describe(*file); }};
}

}  // namespace throng
