#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <optional>

#include "apps/command.h"
#include "base/errors.h"

namespace throng {
namespace {

/// The whole text as a number of type T, or nothing.
template <typename T>
std::optional<T> number_of(const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::string unknown_option(const CLI::App& app, const std::string& where, std::string found) {
  found = found.substr(0, found.find('='));
  return fmt::format("{}: unknown option '{}'{}; `{} --help` lists them", where, found,
                     did_you_mean(found, option_names(app)), where);
}

}  // namespace

CLI::Validator number_option(double low, double high, bool open, const std::string& what) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const std::optional<double> value = number_of<double>(text);
        if (value && std::isfinite(*value) && (open ? *value > low : *value >= low) &&
            *value <= high)
          return "";
        return fmt::format("expected {}, found '{}'", what, text);
      },
      "");
}

void require_names(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string kind = option->get_type_name();
    if (kind != "FILE" && kind != "DIR" && kind != "URL") continue;
    for (const std::string& name : option->results()) {
      if (name.empty()) throw InputError(option->get_name(), "a name", "none");
      if (name == "-" && option->get_name() != "--json")
        throw InputError(option->get_name(), "a name (./- for a file that is called so)",
                         "'-': only --json writes to the standard output");
    }
  }
}

CLI::Validator whole_option(int64_t low, int64_t high, const std::string& what) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const std::optional<int64_t> value = number_of<int64_t>(text);
        if (value && *value >= low && *value <= high) return "";
        return fmt::format("expected {}, found '{}'", what, text);
      },
      "");
}

CLI::Validator name_option(std::vector<std::string> names) {
  return CLI::Validator(
      [names = std::move(names)](std::string& text) -> std::string {
        if (std::find(names.begin(), names.end(), text) != names.end()) return "";
        return fmt::format("expected one of {}, found '{}'{}", fmt::join(names, ", "), text,
                           did_you_mean(text, names));
      },
      "");
}

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* at = &app;
  std::string where = app.get_name();
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->parsed()) continue;
    at = command;
    where += " " + command->get_name();
  }

  // An option that does not exist is the cause of whatever else the parser misses.
  for (const std::string& word : at->remaining())
    if (word.starts_with("-") && word.size() > 1) return unknown_option(*at, where, word);
  for (const std::string& word : app.remaining())
    if (word.starts_with("-") && word.size() > 1) return unknown_option(app, app.get_name(), word);
  if (at == &app && !app.remaining().empty()) {
    const std::string word = app.remaining().front();  // a copy: remaining() is a temporary
    return fmt::format("{}: unknown command '{}'{}; `{} --help` lists them", where, word,
                       did_you_mean(word, command_names(app)), where);
  }
  if (!at->remaining().empty())
    return fmt::format("{}: expected no further argument, found '{}'", where,
                       at->remaining().front());
  return fmt::format("{}: {}", where, error.what());
}

}  // namespace throng
