// CommandLine defines commands and their options and reports errors in what the user typed.
// Invariant: only command_line.cpp includes the parser (CLI11), which takes five seconds to
// compile.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/text.h"

namespace CLI {  // NOLINT(readability-identifier-naming): foreign name
class App;
class Option;
}  // namespace CLI

namespace throng {

/// Words that no command accepts. One line: what was expected, what was found, a suggestion.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One option or positional argument. Each setter returns the option itself.
class Option {
 public:
  explicit Option(CLI::Option& parsed) : parsed_(&parsed) {}

  Option* required();
  /// Checks an argument before conversion.
  Option* check(OptionCheck check);
  /// Changes an argument before it is checked.
  Option* transform(void (*change)(std::string& argument));
  /// FILE, DIR or URL: the argument must not be empty.
  Option* type_name(const std::string& name);
  /// Takes `count` values, one after the other.
  Option* expected(int count);
  Option* expected(int min, int max);
  /// May occur several times.
  Option* take_many();
  /// Value of an option given without one.
  Option* default_str(const std::string& value);
  Option* needs(Option* other);
  Option* excludes(Option* other);
  Option* excludes(const std::string& other);

  /// Whether the option was given.
  bool is_given() const;

 private:
  CLI::Option* parsed_;
};

/// The options of a command.
class CommandOptions {
 public:
  explicit CommandOptions(CLI::App& parsed) : parsed_(&parsed) {}
  CommandOptions(const CommandOptions&) = delete;
  CommandOptions& operator=(const CommandOptions&) = delete;

  void footer(const std::string& text);
  /// `value` is unchanged unless the option is given; for the types listed in command_line.cpp.
  template <typename T>
  Option* add_option(const std::string& name, T& value, const std::string& about);
  /// An option whose word holds `count` numbers separated by `between`, each of which passes
  /// `number`. `what` completes "expected ...".
  template <typename T>
  Option* add_list(const std::string& name, std::vector<T>& values, size_t count, char between,
                   const OptionCheck& number, const std::string& what, const std::string& about);
  Option* add_flag(const std::string& name, bool& value, const std::string& about);
  /// `take` receives an argument that has passed `check`.
  Option* add_value(const std::string& name, OptionCheck check,
                    std::function<void(const std::string&)> take, const std::string& about);
  Option* add_flag(const std::string& name, std::function<void(bool)> take,
                   const std::string& about);

  /// Whether the command was given.
  bool is_given() const;
  /// Throws InputError if an option for a file, folder or URL is empty, or "-", which only --json
  /// accepts.
  void require_names() const;

 private:
  CLI::App* parsed_;
  std::deque<Option> options_;  ///< a deque keeps pointers to its elements valid
};

class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& about, const std::string& footer,
              const std::string& version);
  ~CommandLine();

  CommandOptions* add_subcommand(const std::string& name, const std::string& about);
  bool has_command(const std::string& name) const;

  /// Parses the words after the program's name. Returns the text of --help or --version, if
  /// requested. Throws UsageError.
  std::optional<std::string> parse(std::vector<std::string> words);
  std::string help() const;

 private:
  std::unique_ptr<CLI::App> parsed_;
  std::deque<CommandOptions> commands_;
};

}  // namespace throng
