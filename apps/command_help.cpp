#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "base/say.h"

namespace throng {

Command add_help_command(CLI::App& parent) {
  CLI::App* app = parent.add_subcommand("help", "The options of a command");
  std::vector<std::string> names;
  for (const CLI::App* command : parent.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  const auto name = std::make_shared<std::string>();
  app->add_option("COMMAND", *name, "One of those that `throng help` lists")
      ->check(name_option(names));
  return {app, [&parent, name] {
            const CLI::App* about = name->empty() ? &parent : parent.get_subcommand(*name);
            show("{}", about->help(name->empty() ? "" : parent.get_name()));
            return kExitFine;
          }};
}

}  // namespace throng
