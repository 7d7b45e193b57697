#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

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

namespace throng {
namespace {

constexpr int kDefaultPort = 7684;  // the number of the LCM port: one to remember
constexpr std::chrono::milliseconds kPollPeriod{50};

constexpr const char* kViewFooter = R"(
Without LOG the page shows the run that is heard over LCM, whichever process computes it, and waits
for one. With LOG it plays, steps and scrubs. --html writes the page and the recorded run into one
file that opens from disk; no server is started.

Examples:
  throng run plaza --pace 1 & throng view
  throng view out/plaza.lcmlog
  throng view out/plaza.lcmlog --html plaza.html)";

struct ViewCommand {
  std::string log;
  std::string lcm{kDefaultLcmUrl};
  std::string html;
  double html_limit_mb = kReplayLimitMb;
  WebOptions web;
};

/// `look`: called now and then.
template <typename Poll>
void serve(WebServer& server, const std::string& what, const Poll& poll) {
  const StopSignal stop;
  print_result("{}  {}; Ctrl-C ends\n", server.url(), what);
  flush_results();
  while (!StopSignal::requested()) {
    std::this_thread::sleep_for(kPollPeriod);
    poll();
  }
}

/// As the page says it, once the whole log was read.
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
      throw InputError("throng view --html", "a LOG to put into the file",
                       "none; `throng run SCENE --html FILE` records as it runs");
    OutputPlan plan;
    plan.reads("which is recorded", command.log);
    plan.writes({.option = "--html", .path = command.html, .is_recording = true});
    const OpenOutputs outputs = plan.open();
    const ReplayReport report =
        write_replay(command.log, command.html, page_html(), command.html_limit_mb);
    for (const std::string& note : outputs.notes()) print_message("note: {}\n", note);
    print_result("{}: {:.2f} MB, {}, {:.1f} s\n", command.html,
                 static_cast<double>(report.bytes) * 1e-6,
                 counted(report.avatars, "person", "people"), report.seconds);
    if (report.problem.empty()) return kExitSuccess;
    print_message("note: {}: {} The page says so, too.\n", command.log, report.problem);
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
  CommandOptions* app =
      parent.add_subcommand("view", "The 3-D page: a live run, a log, or one file");
  app->footer(kViewFooter);
  const auto command = std::make_shared<ViewCommand>();
  command->web.port = kDefaultPort;
  Option* log = app->add_option("LOG", command->log, "The log of a run; without it, live");
  app->add_option("--lcm", command->lcm, fmt::format("Where to listen [{}]", command->lcm))
      ->type_name("URL")
      ->excludes(log);
  app->add_option("--port", command->web.port, fmt::format("0: any free one [{}]", kDefaultPort))
      ->check(whole_option(0, 65535, "a port from 0 to 65535"))
      ->type_name("P");
  app->add_option("--address", command->web.address,
                  "Where to serve; 0.0.0.0 for a network that you trust [127.0.0.1]")
      ->type_name("IP");
  app->add_option("--html", command->html, "Writes page and log as one file")->type_name("FILE");
  app->add_option("--html-limit-mb", command->html_limit_mb,
                  fmt::format("The file may be no larger [{:g}]", kReplayLimitMb))
      ->check(number_option(0, 1000, true, "megabytes above 0"))
      ->type_name("MB");
  return {app, [command] { return view(*command); }};
}

}  // namespace throng
