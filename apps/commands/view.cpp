#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/text.h"
#include "viewer/replay/replay.h"
#include "viewer/server/live_view.h"
#include "viewer/server/log_view.h"
#include "viewer/server/page.h"
#include "viewer/server/web_protocol.h"

namespace throng {
namespace {

constexpr int kDefaultPort = 7684;  // same number as Throng's LCM port
constexpr std::chrono::milliseconds kPollPeriod{50};

constexpr const char* kViewFooter = R"(
Without LOG the page shows the run received over LCM, from any process, and waits for one. With LOG it plays,
steps and scrubs the log. --html writes page and log into one file that opens from disk, without a server.

Examples:
  throng run plaza --pace 1 & throng view
  throng view out/plaza.lcmlog
  throng view out/plaza.lcmlog --html plaza.html
  throng view --host-name hub.example.org           behind a proxy, for example of Jupyter or Codespaces
  throng view --address 0.0.0.0 --host-name crowd.lan)";

struct ViewCommand {
  std::string log;
  std::string lcm{kDefaultLcmUrl};
  std::string html;
  double html_limit_mb = kReplayLimitMb;
  WebOptions web;
};

std::string host_name_option(const std::string& argument) {
  if (is_host_name(argument)) return "";
  return fmt::format(
      "expected a host name without scheme, port and path, such as crowd.example.org, found {}",
      in_quotes(argument));
}

/// Serves until a signal; calls `poll` every kPollPeriod. Prints the first refusal: behind a proxy
/// the page itself cannot state why its socket was refused.
template <typename Poll>
void serve(WebServer& server, const std::string& what, const Poll& poll) {
  const StopSignal stop;
  print_result("{}  {}; Ctrl-C ends\n", server.url(), what);
  flush_results();
  bool is_reported = false;
  uint64_t stalled = 0;
  while (!StopSignal::requested()) {
    std::this_thread::sleep_for(kPollPeriod);
    poll();
    if (const uint64_t before = std::exchange(stalled, server.stalled()); stalled > before)
      print_message("note: {} disconnected because nothing was read\n",
                    counted(stalled - before, "page was", "pages were"));
    if (is_reported || server.rejected() == 0) continue;
    const std::string refusal = server.refusal();
    is_reported = !refusal.empty();
    if (is_reported) print_message("note: a page was refused: {}\n", refusal);
  }
}

/// Serves a log. The page reports damage once it has read the whole log.
void serve_log(const ViewCommand& command) {
  LogView log(command.log, command.web, page_html());
  bool is_reported = false;
  serve(log.server(), command.log, [&] {
    if (is_reported || !log.index().is_complete()) return;
    is_reported = true;
    if (const std::string missing = log.index().problem(); !missing.empty())
      print_message("note: {}: {}\n", command.log, missing);
  });
}

int view(const ViewCommand& command) {
  if (!command.html.empty()) {
    if (command.log.empty())
      throw InputError("throng view --html", "a LOG to write into the file",
                       "none; `throng run SCENE --html FILE` records as it runs");
    OutputPlan plan;
    plan.reads("which --html reads", command.log);
    plan.writes({.option = "--html", .path = command.html, .is_recording = true});
    const OpenOutputs outputs = plan.open();
    const ReplayReport report =
        write_replay(command.log, command.html, page_html(), command.html_limit_mb);
    for (const std::string& note : outputs.notes()) print_message("note: {}\n", note);
    print_result("{}: {:.2f} MB, {}, {:.1f} s\n", command.html,
                 static_cast<double>(report.bytes) * 1e-6,
                 counted(report.avatars, "person", "people"), report.seconds);
    if (report.problem.empty()) return kExitSuccess;
    print_message("note: {}: {} The page shows this note.\n", command.log, report.problem);
    return kExitCheckFailed;
  }
  if (!command.log.empty()) {
    serve_log(command);
  } else {
    LiveView live(command.lcm, command.web, page_html());
    serve(live.server(), fmt::format("listening to {}", command.lcm), [] {});
  }
  return kExitSuccess;
}

}  // namespace

Command add_view_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand(
      "view", "Show a live run or a log as a 3-D page, or write it to a file");
  app->footer(kViewFooter);
  const auto command = std::make_shared<ViewCommand>();
  command->web.port = kDefaultPort;
  Option* log = app->add_option("LOG", command->log, "Log of a run; without it, the live run");
  app->add_option("--lcm", command->lcm, fmt::format("LCM URL to listen to [{}]", command->lcm))
      ->type_name("URL")
      ->excludes(log);
  app->add_option("--port", command->web.port,
                  fmt::format("Port of the web server; 0: any free one [{}]", kDefaultPort))
      ->check(whole_option(0, 65535, "a port from 0 to 65535"))
      ->type_name("P");
  app->add_option("--address", command->web.address,
                  "Address of the web server; 0.0.0.0 on trusted networks only [127.0.0.1]")
      ->type_name("IP");
  app->add_option("--host-name", command->web.host_names,
                  "Name by which browsers reach the server or the proxy before it; may be repeated")
      ->take_many()
      ->check(host_name_option)
      ->type_name("NAME");
  app->add_option("--html", command->html, "Write page and log into one file")->type_name("FILE");
  app->add_option("--html-limit-mb", command->html_limit_mb,
                  fmt::format("Maximum size of the file in MB [{:g}]", kReplayLimitMb))
      ->check(number_option(0, 1000, true, "megabytes above 0"))
      ->type_name("MB");
  return {app, [command] { return view(*command); }};
}

}  // namespace throng
