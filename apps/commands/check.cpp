#include <fmt/format.h>

#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "base/console.h"
#include "base/errors.h"
#include "lcm_io/log/log_check.h"

namespace throng {
namespace {

constexpr const char* kCheckFooter = R"(
A log is sound if every byte belongs to a message, no message is damaged or missing, every contact that
begins also ends, and the events have the run's hash. Exit code 1: the log is not sound, or it ends before
the end of its run.

Examples:
  throng check out/plaza.lcmlog
  throng check torn.lcmlog --repair sound.lcmlog)";

struct CheckOptions {
  std::string log;
  std::string repaired;
};

int check(const CheckOptions& options) {
  OutputPlan plan;
  plan.reads("which is checked", options.log);
  plan.writes({.option = "--repair",
               .path = options.repaired,
               .mode = WriteMode::kStreamed,
               .is_recording = true});
  plan.check();
  const LogReport report = check_log(options.log);
  print_result("{}: {}\n", options.log,
               !report.is_sound() ? "not sound"
               : report.finished  ? "sound"
                                  : "sound, but cut off");
  print_result("  messages   {} of Throng, {} of others, {} bytes\n",
               report.log_events - report.foreign_messages, report.foreign_messages, report.bytes);
  print_result("  events     {} begin, {} end, {} open\n", report.begins, report.ends,
               report.open_pairs);
  const auto& levels = report.begins_by_level;
  if (levels[0] + levels[1] > 0 || (levels[2] > 0 && levels[3] > 0))
    print_result(
        "  levels     contacts by level: spheres {}, boxes {}, part volumes {}, triangles {}\n",
        levels[0], levels[1], levels[2], levels[3]);
  print_result("  frames     {}, {:.2f} s\n", report.last_frame + 1,
               static_cast<double>(report.last_utime_us) * 1e-6);
  for (const std::string& line : describe_coverage(report)) print_result("  checksums  {}\n", line);
  if (!report.omits.empty())
    print_result("  omits      {} (strategy {})\n", report.omits, report.strategy);
  if (!report.cut_off.empty()) print_result("  end        {}\n", report.cut_off);
  for (const std::string& problem : report.problems) print_result("  problem    {}\n", problem);
  const int64_t unlisted = report.problem_count - static_cast<int64_t>(report.problems.size());
  if (unlisted > 0) print_result("  problem    and {} more\n", unlisted);
  if (!options.repaired.empty()) {
    if (report.log_events == 0) throw InputError(options.log, "a log with a sound message", "none");
    const OpenOutputs outputs = plan.open();
    for (const std::string& note : outputs.notes()) print_message("note: {}\n", note);
    const int64_t messages = repair_log(options.log, options.repaired);
    print_result("  repaired   {}: {} sound messages\n", options.repaired, messages);
  }
  return report.is_complete() ? kExitSuccess : kExitCheckFailed;
}

}  // namespace

Command add_check_command(CommandLine& parent) {
  CommandOptions* app =
      parent.add_subcommand("check", "Check a log: numbering, gaps, pairing of events");
  app->footer(kCheckFooter);
  const auto options = std::make_shared<CheckOptions>();
  app->add_option("LOG", options->log, "Log to check")->required();
  app->add_option("--repair", options->repaired, "Write the sound messages to a new log")
      ->type_name("FILE");
  return {app, [options] { return check(*options); }};
}

}  // namespace throng
