// `throng`: the command line over the library.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <vector>

#include "apps/command.h"
#include "base/errors.h"
#include "base/version.h"

namespace throng {
namespace {

constexpr const char* kAbout =
    "Throng tells which body part of whom touches which body part of whom, in crowds.";
constexpr const char* kFooter = R"(
Examples:
  throng run plaza                                  500 people, a log in out/
  throng run plaza --avatars 5000 --seconds 2       more of them
  throng info avatars/models/adult/adult.urdf       a model, checked and described

Exit codes: 0 fine, 1 a check failed, 2 bad input, 3 the environment failed.)";

int say(const std::string& message, int exit_code) {
  fmt::print(stderr, "{}\n", message);
  return exit_code;
}

/// Results that did not reach their reader are no results.
int flushed(int exit_code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  return say("throng: could not write to the standard output", kExitEnvironment);
}

int run(int argc, char** argv) {
  CLI::App app(kAbout, "throng");
  app.footer(kFooter);
  app.set_version_flag("-V,--version", fmt::format("throng {} ({})", version(), commit()),
                       "Display program version information and exit");
  app.get_formatter()->column_width(34);
  const std::vector<Command> commands = {add_run_command(app),     add_scenes_command(app),
                                         add_info_command(app),    add_check_command(app),
                                         add_monitor_command(app), add_render_command(app),
                                         add_view_command(app),    add_paper_command(app),
                                         add_bench_command(app),   add_validate_command(app)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    app.exit(asked_for_help);
    return flushed(kExitFine);
  } catch (const CLI::ParseError& error) {
    return say(explain(app, error), kExitBadInput);
  }
  for (const Command& command : commands)
    if (command.app->parsed()) return flushed(command.action());
  fmt::print(stderr, "{}", app.help());
  return kExitBadInput;
}

}  // namespace
}  // namespace throng

int main(int argc, char** argv) {
  // A pipe whose reader has gone and a file that reached its limit are errors like a full disk, not
  // a silent death.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return throng::run(argc, argv);
  } catch (const throng::InputError& error) {
    return throng::say(error.what(), throng::kExitBadInput);
  } catch (const throng::EnvironmentError& error) {
    return throng::say(error.what(), throng::kExitEnvironment);
  } catch (const std::bad_alloc&) {
    return throng::say("throng: out of memory", throng::kExitEnvironment);
  } catch (const std::exception& error) {
    return throng::say(fmt::format("throng: {}", error.what()), throng::kExitEnvironment);
  }
}
