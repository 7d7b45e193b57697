// The commands of `throng`: each adds its options to the parser and returns what to do.
// One rule: results go to stdout, the rest to stderr; errors leave as exceptions and main() turns
// them into exit codes.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <string>
#include <vector>

namespace throng {

/// Exit codes of every command.
inline constexpr int kExitFine = 0;
inline constexpr int kExitCheckFailed = 1;
inline constexpr int kExitBadInput = 2;
inline constexpr int kExitEnvironment = 3;

/// A subcommand and its action; the action returns the exit code.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> action;
};

Command add_run_command(CLI::App& parent);
Command add_scenes_command(CLI::App& parent);
Command add_info_command(CLI::App& parent);
Command add_check_command(CLI::App& parent);
Command add_monitor_command(CLI::App& parent);
Command add_render_command(CLI::App& parent);
Command add_view_command(CLI::App& parent);
Command add_paper_command(CLI::App& parent);
Command add_bench_command(CLI::App& parent);
Command add_validate_command(CLI::App& parent);

/// Accepts a number in [low, high] (above low if `open`); `what` completes "expected ...".
CLI::Validator number_option(double low, double high, bool open, const std::string& what);
/// Accepts a whole number in [low, high].
CLI::Validator whole_option(int64_t low, int64_t high, const std::string& what);
/// Accepts one of the names, with a did-you-mean.
CLI::Validator name_option(std::vector<std::string> names);

/// Throws InputError where an option that names a file, a folder or a URL names none, or "-", which
/// only --json takes.
void require_names(const CLI::App& command);

/// One line for what the parser threw: what was expected, what was found, and what was meant.
std::string explain(const CLI::App& app, const CLI::ParseError& error);

}  // namespace throng
