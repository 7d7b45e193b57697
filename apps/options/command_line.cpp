#include "apps/options/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <sstream>
#include <utility>

#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
  return names;
}

std::string unknown_option(const CLI::App& app, const std::string& where, std::string found) {
  found = found.substr(0, found.find('='));
  return fmt::format("{}: unknown option '{}'{}; `{} --help` lists them", where, found,
                     did_you_mean(found, option_names(app)), where);
}

/// One line for a parser error: what was expected, what was found, and a suggestion.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* at = &app;
  std::string where = app.get_name();
  for (const CLI::App* command : commands_of(app)) {
    if (!command->parsed()) continue;
    at = command;
    where += " " + command->get_name();
  }

  // Report an unknown option first: it causes the other errors.
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

}  // namespace

Option* Option::required() {
  parsed_->required();
  return this;
}

Option* Option::check(OptionCheck check) {
  parsed_->check(
      CLI::Validator([check = std::move(check)](std::string& text) { return check(text); }, ""));
  return this;
}

Option* Option::transform(void (*change)(std::string& argument)) {
  parsed_->transform(CLI::Validator(
      [change](std::string& text) {
        change(text);
        return std::string();
      },
      ""));
  return this;
}

Option* Option::type_name(const std::string& name) {
  parsed_->type_name(name);
  return this;
}

Option* Option::expected(int count) {
  parsed_->expected(count);
  return this;
}

Option* Option::expected(int min, int max) {
  parsed_->expected(min, max);
  return this;
}

Option* Option::take_many() {
  parsed_->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return this;
}

Option* Option::default_str(const std::string& value) {
  parsed_->default_str(value);
  return this;
}

Option* Option::needs(Option* other) {
  parsed_->needs(other->parsed_);
  return this;
}

Option* Option::excludes(Option* other) {
  parsed_->excludes(other->parsed_);
  return this;
}

Option* Option::excludes(const std::string& other) {
  parsed_->excludes(other);
  return this;
}

bool Option::is_given() const { return parsed_->count() > 0; }

void CommandOptions::footer(const std::string& text) { parsed_->footer(text); }

template <typename T>
Option* CommandOptions::add_option(const std::string& name, T& value, const std::string& about) {
  return &options_.emplace_back(*parsed_->add_option(name, value, about));
}

template Option* CommandOptions::add_option(const std::string&, int&, const std::string&);
template Option* CommandOptions::add_option(const std::string&, int64_t&, const std::string&);
template Option* CommandOptions::add_option(const std::string&, uint64_t&, const std::string&);
template Option* CommandOptions::add_option(const std::string&, double&, const std::string&);
template Option* CommandOptions::add_option(const std::string&, std::string&, const std::string&);
template Option* CommandOptions::add_option(const std::string&, std::optional<int>&,
                                            const std::string&);
template Option* CommandOptions::add_option(const std::string&, std::optional<uint64_t>&,
                                            const std::string&);
template Option* CommandOptions::add_option(const std::string&, std::optional<double>&,
                                            const std::string&);
template Option* CommandOptions::add_option(const std::string&, std::optional<std::string>&,
                                            const std::string&);
template Option* CommandOptions::add_option(const std::string&, std::vector<std::string>&,
                                            const std::string&);

template <typename T>
Option* CommandOptions::add_list(const std::string& name, std::vector<T>& values, size_t count,
                                 char between, const OptionCheck& number, const std::string& what,
                                 const std::string& about) {
  const auto take = [&values, between](const std::string& text) {
    values.clear();
    for (const std::string& piece : split_text(text, between)) {
      T value{};
      std::from_chars(piece.data(), piece.data() + piece.size(), value);  // checked before
      values.push_back(value);
    }
  };
  return options_.emplace_back(*parsed_->add_option_function<std::string>(name, take, about))
      .check(list_option(number, count, between, what));
}

template Option* CommandOptions::add_list(const std::string&, std::vector<int64_t>&, size_t, char,
                                          const OptionCheck&, const std::string&,
                                          const std::string&);
template Option* CommandOptions::add_list(const std::string&, std::vector<float>&, size_t, char,
                                          const OptionCheck&, const std::string&,
                                          const std::string&);

Option* CommandOptions::add_flag(const std::string& name, bool& value, const std::string& about) {
  return &options_.emplace_back(*parsed_->add_flag(name, value, about));
}

Option* CommandOptions::add_value(const std::string& name, OptionCheck check,
                                  std::function<void(const std::string&)> take,
                                  const std::string& about) {
  return options_
      .emplace_back(*parsed_->add_option_function<std::string>(name, std::move(take), about))
      .check(std::move(check));
}

Option* CommandOptions::add_flag(const std::string& name, std::function<void(bool)> take,
                                 const std::string& about) {
  const auto count = [take = std::move(take)](int64_t found) { take(found > 0); };
  return &options_.emplace_back(*parsed_->add_flag_function(name, count, about));
}

bool CommandOptions::is_given() const { return parsed_->parsed(); }

void CommandOptions::require_names() const {
  for (const CLI::Option* option : std::as_const(*parsed_).get_options()) {
    const std::string kind = option->get_type_name();
    if (kind != "FILE" && kind != "DIR" && kind != "URL") continue;
    for (const std::string& name : option->results()) {
      if (name.empty()) throw InputError(option->get_name(), "a name", "none");
      if (name == "-" && option->get_name() != "--json")
        throw InputError(option->get_name(), "a name (./- for a file named -)",
                         "'-'; only --json writes to stdout");
    }
  }
}

CommandLine::CommandLine(const std::string& name, const std::string& about,
                         const std::string& footer, const std::string& version)
    : parsed_(std::make_unique<CLI::App>(about, name)) {
  parsed_->footer(footer);
  parsed_->set_version_flag("-V,--version", version, "Print version and commit");
  parsed_->get_formatter()->column_width(34);
}

CommandLine::~CommandLine() = default;

CommandOptions* CommandLine::add_subcommand(const std::string& name, const std::string& about) {
  return &commands_.emplace_back(*parsed_->add_subcommand(name, about));
}

bool CommandLine::has_command(const std::string& name) const {
  const std::vector<std::string> names = command_names(*parsed_);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::optional<std::string> CommandLine::parse(std::vector<std::string> words) {
  std::reverse(words.begin(), words.end());  // the parser's order
  try {
    parsed_->parse(std::move(words));
  } catch (const CLI::Success& asked) {
    std::ostringstream out, err;
    parsed_->exit(asked, out, err);
    return out.str();
  } catch (const CLI::ParseError& error) {
    throw UsageError(explain(*parsed_, error));
  }
  return std::nullopt;
}

std::string CommandLine::help() const { return parsed_->help(); }

}  // namespace throng
