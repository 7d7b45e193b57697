// `throng`: the command line over the library.

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <initializer_list>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/version.h"

namespace throng {
namespace {

constexpr const char* kAbout =
    "Throng simulates crowds of articulated agents and detects every contact between their body "
    "parts.";
constexpr const char* kFooter = R"(
Examples:
  throng run plaza                                  simulate 500 people, write a log to out/
  throng run plaza --avatars 5000 --seconds 2       simulate a larger crowd
  throng info avatars/models/adult/adult.urdf       check and describe a body model
  throng help run                                   print the options of a command

Exit codes: 0 success, 1 a check failed, 2 bad input, 3 fault of the environment. Work stopped by a signal
prints its summary and exits with 130 (SIGINT, Ctrl-C), 143 (SIGTERM) or 129 (SIGHUP).)";

int failed(const std::string& message, int exit_code) {
  print_message("{}\n", message);
  return exit_code;
}

/// Fails if results were not written, except to a pipe whose reader has closed it. A terminal that
/// closes also sends SIGHUP.
int ended(int exit_code) {
  if (flush_results() || stdout_is_closed() ||
      (exit_code != kExitSuccess && exit_code == StopSignal::exit_code() &&
       StopSignal::name() == "SIGHUP"))
    return exit_code;
  return failed("throng: could not write to the standard output", kExitEnvironment);
}

/// Rewrites words that the parser does not accept: `throng help run` becomes `throng run --help`,
/// and `monitor --json`, a flag, also accepts "-". Unknown commands are left to the parser.
std::vector<std::string> as_parsed(const CommandLine& line, std::vector<std::string> words) {
  if (words.empty()) return words;
  if (words.front() == "monitor") std::erase(words, "-");
  if (words.front() != "help") return words;
  words.erase(words.begin());
  if (words.empty() || words.front().starts_with("-") || line.has_command(words.front()))
    words.emplace_back("--help");
  return words;
}

int run(int argc, char** argv) {
  CommandLine line("throng", kAbout, kFooter, fmt::format("throng {} ({})", version(), commit()));
  const std::vector<Command> commands = {
      add_run_command(line),      add_scenes_command(line),  add_info_command(line),
      add_check_command(line),    add_monitor_command(line), add_render_command(line),
      add_view_command(line),     add_paper_command(line),   add_bench_command(line),
      add_validate_command(line), add_compare_command(line), add_study_command(line),
      add_export_command(line),   add_import_command(line)};
  line.add_subcommand("help", "Print the options of a command: throng help COMMAND");
  if (const auto text = line.parse(as_parsed(line, {argv + 1, argv + argc}))) {
    print_result("{}", *text);
    return kExitSuccess;
  }
  for (const Command& command : commands)
    if (command.app->is_given()) {
      command.app->require_names();
      return command.action();
    }
  print_message("{}", line.help());
  return kExitBadInput;
}

int run_guarded(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const UsageError& error) {
    return failed(error.what(), kExitBadInput);
  } catch (const InputError& error) {
    return failed(error.what(), kExitBadInput);
  } catch (const EnvironmentError& error) {
    return failed(error.what(), kExitEnvironment);
  } catch (const std::bad_alloc&) {
    return failed("throng: out of memory", kExitEnvironment);
  } catch (const std::exception& error) {
    return failed(fmt::format("throng: {}", error.what()), kExitEnvironment);
  }
}

/// Opens closed standard streams on /dev/null before any other file, so no log gets the number of
/// stderr. A closed stdin then reads as empty, and output to a closed stderr is dropped. Output to
/// a closed stdout still fails, because its results are lost.
void open_standard_files() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0) continue;
    // open() returns the lowest free number, which is this one. Writing to a read-only descriptor
    // fails like writing to a closed one.
    const int mode = descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY;
    [[maybe_unused]] const int opened = open("/dev/null", mode);
  }
}

}  // namespace
}  // namespace throng

int main(int argc, char** argv) {
  throng::open_standard_files();
  throng::StopSignal::install();
  // SIGXFSZ ignored: a file at its size limit is an error like a full disk. SIGPIPE ignored: a
  // reader that closes its pipe ends the output, not the work.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  const int exit_code = throng::ended(throng::run_guarded(argc, argv));
  throng::abandon_unfinished_work(exit_code);
  return exit_code;
}
