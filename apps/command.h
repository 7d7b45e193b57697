// Command is a subcommand of `throng` with its action.
// Invariant: results go to stdout, the rest to stderr. Errors are exceptions, which main() turns
// into exit codes.
#pragma once

#include <functional>

#include "apps/options/command_line.h"

namespace throng {

/// Exit codes of every command.
inline constexpr int kExitSuccess = 0;
inline constexpr int kExitCheckFailed = 1;
inline constexpr int kExitBadInput = 2;
inline constexpr int kExitEnvironment = 3;

/// A subcommand and its action; the action returns the exit code.
struct Command {
  CommandOptions* app = nullptr;
  std::function<int()> action;
};

Command add_run_command(CommandLine& parent);
Command add_scenes_command(CommandLine& parent);
Command add_info_command(CommandLine& parent);
Command add_check_command(CommandLine& parent);
Command add_monitor_command(CommandLine& parent);
Command add_render_command(CommandLine& parent);
Command add_view_command(CommandLine& parent);
Command add_paper_command(CommandLine& parent);
Command add_bench_command(CommandLine& parent);
Command add_validate_command(CommandLine& parent);
Command add_compare_command(CommandLine& parent);
Command add_study_command(CommandLine& parent);
Command add_export_command(CommandLine& parent);
Command add_import_command(CommandLine& parent);

}  // namespace throng
