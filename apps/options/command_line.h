// The command line: commands, their options, and what is wrong with what somebody typed.
// One rule: command_line.cpp alone sees the parser that we use (CLI11), which takes five seconds to
// compile wherever it is included.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/text.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the name is theirs
class App;
class Option;
}  // namespace CLI

namespace throng {

/// Words that no command takes. One line: what was expected, what was found, what was meant.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One option, or one argument without a name. Each function returns the option itself.
class Option {
 public:
  explicit Option(CLI::Option& parsed) : parsed_(&parsed) {}

  Option* required();
  /// Looks at an argument before it becomes a value.
  Option* check(OptionCheck check);
  /// Changes an argument before anything looks at it.
  Option* transform(void (*change)(std::string& argument));
  /// FILE, DIR or URL: what is given has to name something.
  Option* type_name(const std::string& name);
  /// So many values, one after the other.
  Option* expected(int count);
  Option* expected(int min, int max);
  /// May be given several times.
  Option* take_many();
  /// What it is when named without a value.
  Option* default_str(const std::string& value);
  Option* needs(Option* other);
  Option* excludes(Option* other);
  Option* excludes(const std::string& other);

  /// Whether it was given.
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
  /// `value` keeps what it is unless the option is given; for the types listed in command_line.cpp.
  template <typename T>
  Option* add_option(const std::string& name, T& value, const std::string& about);
  /// An option of one word: `count` numbers with `between` between them, each of which passes
  /// `number`. `what` completes "expected ...".
  template <typename T>
  Option* add_list(const std::string& name, std::vector<T>& values, size_t count, char between,
                   const OptionCheck& number, const std::string& what, const std::string& about);
  Option* add_flag(const std::string& name, bool& value, const std::string& about);
  /// `take` reads an argument that has passed `check`.
  Option* add_value(const std::string& name, OptionCheck check,
                    std::function<void(const std::string&)> take, const std::string& about);
  Option* add_flag(const std::string& name, std::function<void(bool)> take,
                   const std::string& about);

  /// Whether the command was given.
  bool is_given() const;
  /// Throws InputError where an option that names a file, a folder or a URL names none, or "-",
  /// which only --json takes.
  void require_names() const;

 private:
  CLI::App* parsed_;
  std::deque<Option> options_;  ///< pointers into it stay
};

class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& about, const std::string& footer,
              const std::string& version);
  ~CommandLine();

  CommandOptions* add_subcommand(const std::string& name, const std::string& about);
  bool has_command(const std::string& name) const;

  /// Reads the words after the program's name. Returns what the parser itself has to say: help or
  /// the version. Throws UsageError.
  std::optional<std::string> parse(std::vector<std::string> words);
  std::string help() const;

 private:
  std::unique_ptr<CLI::App> parsed_;
  std::deque<CommandOptions> commands_;
};

}  // namespace throng
