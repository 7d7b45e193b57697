#include "apps/options/run_arguments.h"

#include <string_view>

#include "base/errors.h"

namespace throng {
namespace {

void add(CommandOptions& app, const RunOption& row, RunOptions& options) {
  const std::string name = argument_of(row.name);
  const auto take = [&row, &options, name](const std::string& text) {
    row.read(text, name, options);
  };
  if (row.kind == RunOption::Kind::kFlag) {
    app.add_flag(
        name, [take](bool is_on) { take(is_on ? "true" : "false"); }, row.meaning);
    return;
  }
  // The parser prefixes messages of a check with command and option.
  const auto check = [&row](const std::string& text) -> std::string {
    RunOptions ignored;
    try {
      row.read(text, "", ignored);
      return "";
    } catch (const InputError& error) {
      return std::string(error.what()).substr(std::string_view(": ").size());
    }
  };
  app.add_value(name, check, take, row.meaning)->type_name(row.value);
}

}  // namespace

void add_run_options(CommandOptions& app, std::string& file, RunOptions& options) {
  app.add_option("FILE", file, "Scene file, name from `throng scenes`, recording, or log")
      ->required();
  for (const RunOption& row : run_options()) add(app, row, options);
}

void add_run_option(CommandOptions& app, const std::string& name, RunOptions& options) {
  for (const RunOption& row : run_options())
    if (row.name == name) add(app, row, options);
}

void add_recording_options(CommandOptions& app, RunOptions& options) {
  for (const RunOption& row : run_options())
    if (row.is_of_recording && row.name != "sampling") add(app, row, options);
}

}  // namespace throng
