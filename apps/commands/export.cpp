#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "apps/process/progress.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/text.h"
#include "lcm_io/export/csv_export.h"
#include "lcm_io/export/mcap_export.h"
#include "lcm_io/replay/file_kind.h"
#include "scenes/file/scene_fields.h"

namespace throng {
namespace {

constexpr const char* kExportFooter = R"(
--mcap writes a file for Foxglove and other MCAP viewers: /tf, poses of parts; /scene, meshes of bodies and
obstacles; /contact_markers; /contacts, a message per begin and end. --csv writes the messages of a channel, a
row per person, event or frame: events, states, touching,
proximity, contact_points, separation or frame_stats.

Examples:
  throng export out/plaza.lcmlog --mcap plaza.mcap
  throng export out/plaza.lcmlog --mcap plaza.mcap --poses-hz 60
  throng export out/plaza.lcmlog --csv events > events.csv
  throng export out/plaza.lcmlog --csv THRONG_STATES --out states.csv)";

struct ExportOptions {
  std::string log;
  std::string mcap;
  std::string csv;
  std::string out;
  double poses_hz = McapExportOptions{}.poses_hz;
};

int stopped() {
  print_message("stopped by {}\n", StopSignal::name());
  return StopSignal::exit_code();
}

/// Exit code for the export of a log that may be incomplete.
int ended(const std::string& log, const std::string& missing) {
  if (missing.empty()) return kExitSuccess;
  if (StopSignal::requested()) return stopped();
  print_message("note: {}: {} The recorded part is exported.\n", log, missing);
  return kExitCheckFailed;
}

int to_mcap(const ExportOptions& options, ExportedLog& log) {
  constexpr int64_t kShares = 1000;
  ProgressBar progress("export", kShares, "per mille");
  const McapExport done = export_mcap(log, options.mcap, {options.poses_hz}, [&](double share) {
    progress.show(static_cast<int64_t>(share * static_cast<double>(kShares)));
    return !StopSignal::requested();
  });
  print_result("{}: {} of poses, {} and {} of contacts, {:.1f} MB\n", options.mcap,
               counted(done.frames, "frame"), counted(done.begins, "begin"),
               counted(done.ends, "end"), static_cast<double>(done.bytes) * 1e-6);
  return ended(options.log, done.missing);
}

int to_csv(const ExportOptions& options, ExportedLog& log, const std::string& channel) {
  const auto keep_going = [] { return !StopSignal::requested() && !stdout_is_closed(); };
  if (options.out.empty()) {
    const std::string missing = export_csv(
        log, channel, [](std::string_view text) { print_result_text(text); }, keep_going);
    return stdout_is_closed() ? kExitSuccess : ended(options.log, missing);
  }
  std::ofstream out(options.out, std::ios::binary);
  const std::string missing = export_csv(
      log, channel, [&](std::string_view text) { out << text; }, keep_going);
  out.close();
  if (!out) throw EnvironmentError(fmt::format("{}: cannot write", options.out));
  return ended(options.log, missing);
}

int export_log(const ExportOptions& options) {
  if (options.mcap.empty() == options.csv.empty())
    throw InputError("export", "--mcap FILE or --csv CHANNEL",
                     options.mcap.empty() ? "neither" : "both");
  if (!options.out.empty() && options.csv.empty())
    throw InputError("--out", "--csv CHANNEL with it", "none");
  const std::string channel = csv_channel(options.csv);
  if (!options.csv.empty() && channel.empty())
    throw InputError("--csv", "a channel: " + list_of(csv_channels(), " or "),
                     fmt::format("'{}'", options.csv));
  if (!is_log(options.log))
    throw InputError(options.log, "a log of a run", "another file, or none");
  OutputPlan plan;
  plan.reads("the log", options.log);
  plan.writes({.option = "--mcap", .path = options.mcap});
  plan.writes({.option = "--out", .path = options.out, .mode = WriteMode::kStreamed});
  plan.check();
  const StopSignal stop;
  ExportedLog log(options.log, [] { return !StopSignal::requested(); });
  if (log.is_stopped()) return stopped();
  const OpenOutputs outputs = plan.open();
  return options.csv.empty() ? to_mcap(options, log) : to_csv(options, log, channel);
}

}  // namespace

Command add_export_command(CommandLine& parent) {
  CommandOptions* app =
      parent.add_subcommand("export", "Convert a log to MCAP for other viewers, or to a CSV table");
  app->footer(kExportFooter);
  const auto options = std::make_shared<ExportOptions>();
  app->add_option("LOG", options->log, "Log of a run")->required();
  app->add_option("--mcap", options->mcap, "Write this MCAP file")->type_name("FILE");
  app->add_option("--poses-hz", options->poses_hz,
                  "Poses per simulated second, at most the states in the log [10]")
      ->check(number_option(0, 1e4, true, "a number of poses per second above 0"))
      ->type_name("N");
  app->add_option("--csv", options->csv, "Write the messages of a channel: events, states, ...")
      ->type_name("CHANNEL");
  app->add_option("--out", options->out, "Table to write [stdout]")->type_name("FILE");
  return {app, [options] { return export_log(*options); }};
}

}  // namespace throng
