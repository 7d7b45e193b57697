#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands/monitor_screen.h"
#include "apps/commands/monitor_view.h"
#include "apps/process/stop_signal.h"
#include "apps/process/terminal.h"
#include "base/console.h"
#include "base/text.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "lcm_io/wire/receiver.h"

namespace throng {
namespace {

constexpr const char* kMonitorFooter = R"(
Shows channels with rates and missing messages, the stage counters as N_u C_u N_v C_v N_p C_p C_o and T, the
parts that touch most, and the newest contacts by name. In a terminal the newest contacts come first, and keys
sort, filter, choose one of several runs, and quit. Ctrl-C ends it.

Examples:
  throng monitor                                    live, updates in place
  throng monitor --once --json                      listens for 3 s, then prints JSON
  throng monitor --once --json --until-end          listens until the run ends
  throng monitor out/plaza.lcmlog                   the same view of a log

Exit codes: 1 if no message was received.)";

struct MonitorOptions {
  std::string log;
  std::string lcm{kDefaultLcmUrl};
  bool once = false;
  bool json = false;
  bool until_end = false;
  std::optional<double> seconds;
};

constexpr double kOnce_s = 3;
constexpr int64_t kMaxReported = 3;
constexpr std::chrono::milliseconds kWait{50};
constexpr std::chrono::milliseconds kRedraw{200};
constexpr double kLine_s = 1;

int print_view(MonitorView view, bool as_json) {
  view.overall = true;
  if (as_json) {
    using Handler = nlohmann::ordered_json::error_handler_t;
    print_result("{}\n", json_of(view).dump(2, ' ', false, Handler::replace));
  } else {
    for (const std::string& line : lines_of(view)) print_result("{}\n", line);
  }
  if (!view.inbox.runs().empty()) return kExitSuccess;
  print_message("{}: expected a run, found none; {}\n", view.source,
                view.inbox.rejected() > 0
                    ? fmt::format("{} ({})",
                                  counted(view.inbox.rejected(), "message was rejected",
                                          "messages were rejected"),
                                  view.inbox.run().rejection())
                    : "start one with 'throng run SCENE --pace 1'");
  return kExitCheckFailed;
}

double seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// Acts on typed keys and draws if it is time or a key was typed. Returns false to stop.
bool update_screen(Terminal& terminal, MonitorScreen& screen, MonitorView& view, double& drawn_s) {
  const std::string keys = terminal.typed();
  for (const char key : keys)
    if (!screen.press(key)) return false;
  if (keys.empty() && view.now_s - drawn_s < seconds(kRedraw)) return true;
  drawn_s = view.now_s;
  const Terminal::Size size = terminal.size();
  view.width = size.columns;
  view.height = size.rows;
  return terminal.draw(screen.lines(view));
}

/// Prints a line for each second. Returns false if the reader has closed the pipe.
bool print_line(const MonitorView& view, double& printed_s) {
  if (view.now_s - printed_s < kLine_s) return true;
  printed_s = view.now_s;
  print_result("{}\n", line_of(view));
  return flush_results();
}

int watch_live(const MonitorOptions& options) {
  Receiver receiver(options.lcm);
  Monitor monitor(receiver.inbox());
  MonitorView view{receiver.inbox(), monitor, options.lcm};
  const auto start = std::chrono::steady_clock::now();
  const auto now_s = [&start] { return seconds(std::chrono::steady_clock::now() - start); };
  const bool once = options.once || options.json;
  double limit_s = options.seconds.value_or(1e18);
  if (once && !options.seconds && !options.until_end) limit_s = kOnce_s;
  const StopSignal stop;
  {
    std::optional<Terminal> terminal;
    if (!once && Terminal::is_available()) terminal.emplace();
    MonitorScreen screen(receiver.inbox(), terminal && terminal->has_keys());
    double shown_s = 0;
    view.overall = once;
    bool continues = true;
    while (continues && !StopSignal::requested() && now_s() < limit_s) {
      receiver.receive(kWait, [&](const ReceivedMessage& m) { monitor.take(m.update, now_s()); });
      view.now_s = now_s();
      if (options.until_end && receiver.inbox().run().end()) break;
      if (terminal)
        continues = update_screen(*terminal, screen, view, shown_s);
      else if (!once)
        continues = print_line(view, shown_s);
    }
  }
  if (stdout_is_closed()) return kExitSuccess;
  MonitorView all{receiver.inbox(), monitor, options.lcm};
  all.now_s = view.now_s;
  return print_view(all, options.json);
}

int watch_log(const MonitorOptions& options) {
  LogReader log(options.log);
  Inbox inbox;
  Monitor monitor(inbox);
  MonitorView view{inbox, monitor, options.log};
  LogEvent event;
  int64_t damaged = 0, messages = 0;
  std::vector<std::string> damage;
  std::string first_rejection;
  for (;;) {
    const LogReader::Status status = log.next(event);
    if (status == LogReader::Status::kEnd) break;
    if (status != LogReader::Status::kEvent) {
      if (++damaged <= kMaxReported) damage.push_back(log.problem());
      if (!log.resync()) break;
      continue;
    }
    const RunReader::Update update = inbox.take(event.channel, event.data);
    messages += channel_of(event.channel) ? 1 : 0;
    if (first_rejection.empty()) first_rejection = inbox.run().rejection();
    view.now_s = std::max(view.now_s, static_cast<double>(event.stamp_us) * 1e-6);
    monitor.take(update, view.now_s);
  }
  require_this_version(options.log, messages, inbox.rejected(), first_rejection);
  for (const std::string& each : damage) print_message("{}: {}\n", options.log, each);
  if (damaged > kMaxReported)
    print_message("{}: damaged in {} places; run 'throng check' for details\n", options.log,
                  damaged);
  return print_view(view, options.json);
}

}  // namespace

Command add_monitor_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand("monitor", "Watch a live run or a log");
  app->footer(kMonitorFooter);
  const auto options = std::make_shared<MonitorOptions>();
  Option* log = app->add_option("LOG", options->log, "Log to watch instead of a live run");
  app->add_option("--lcm", options->lcm, fmt::format("LCM URL to listen to [{}]", options->lcm))
      ->type_name("URL")
      ->excludes(log);
  app->add_flag("--once", options->once, "Print once, at the end");
  app->add_flag("--json", options->json, "Print JSON once, at the end");
  app->add_flag("--until-end", options->until_end, "Stop when the run has ended");
  app->add_option("--seconds", options->seconds, "Stop after this time in seconds [--once: 3]")
      ->check(number_option(0, 1e9, true, "a number of seconds above 0"))
      ->type_name("S");
  return {app,
          [options] { return options->log.empty() ? watch_live(*options) : watch_log(*options); }};
}

}  // namespace throng
