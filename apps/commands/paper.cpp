#include <fmt/format.h>

#include <memory>
#include <mutex>

#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "apps/output/text_file.h"
#include "apps/process/machine.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/cores.h"
#include "base/figure.h"
#include "bench/paper/report.h"
#include "bench/paper/tables.h"

namespace throng {
namespace {

constexpr const char* kPaperFooter = R"(
Suaib, Bade, Mohamad: Hybrid Collision Culling by Bounding Volumes Manipulation in Massive Rigid
Body Simulation, TELKOMNIKA 11(6), 2013. docs/paper.md explains each number.

Ctrl-C stops it; finished tables are printed.

Examples:
  throng paper --json paper.json
  throng paper --model robot.urdf --frames 100 --out out/robot
  throng paper --seeds 100 --out out/paper)";

struct PaperCommand {
  paper::PaperOptions options;
  std::string out;
  std::string json;
};

/// Result so far, shared with the thread that measures.
struct SharedResult {
  std::mutex mutex;
  paper::PaperResult result;

  paper::PaperResult copy() {
    const std::lock_guard lock(mutex);
    return result;
  }
};

int reproduce_paper(const PaperCommand& command) {
  // Check all outputs before minutes of measuring.
  const StopSignal stop;
  OutputPlan plan;
  plan.reads("the model", command.options.model);
  plan.writes_json(command.json);
  plan.fills("--out", command.out, {"report.html", "report.md", "*.svg", "*.png"});
  if (!command.out.empty()) require_gnuplot();
  const OpenOutputs outputs = plan.open();
  const auto objects = paper::load_objects(command.options.model);
  const auto shared = std::make_shared<SharedResult>();
  const auto experiments = [objects, shared, options = command.options] {
    paper::run_experiments(
        objects, options, [](const std::string& what) { print_message("{}\n", what); },
        [&](const paper::PaperResult& result) {
          const std::lock_guard lock(shared->mutex);
          shared->result = result;
        });
  };
  const bool done = finishes_before_signal(experiments);
  const paper::PaperResult result = shared->copy();
  if (!done) print_message("stopped by {}: finished tables follow\n", StopSignal::name());
  std::string tables;
  for (const paper::Table& table : paper::tables_of(result)) tables += paper::to_text(table) + "\n";
  print_unless_json(command.json, tables);
  const std::string cpu = cpu_name();
  write_json_output(command.json, paper::to_json(result, cpu));
  if (!done) return StopSignal::exit_code();
  if (!command.out.empty()) {
    paper::write_report(result, objects, cpu, command.out);
    print_unless_json(command.json,
                      fmt::format("{0}/report.html and {0}/report.md written\n", command.out));
  }
  return kExitSuccess;
}

}  // namespace

Command add_paper_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand(
      "paper", "Reproduce the tables and figures of Suaib, Bade and Mohamad (2013)");
  app->footer(kPaperFooter);
  const auto command = std::make_shared<PaperCommand>();
  command->options.threads = core_count();
  const auto five = [](const std::string& text) -> std::string {
    return text.ends_with('0') || text.ends_with('5')
               ? ""
               : fmt::format("expected a multiple of 5, found '{}'", text);
  };
  app->add_option("--model", command->options.model, "URDF of the bodies [the bundled adult]")
      ->type_name("URDF");
  app->add_option("--frames", command->options.frames, "Number of frames of Part I [500]")
      ->check(whole_option(10, 10000, "10 to 10000 frames"))
      ->check(five)
      ->type_name("N");
  app->add_option("--seed", command->options.seed, "First random seed [1]")
      ->check(whole_option(0, INT64_MAX, "a whole number from 0"))
      ->type_name("N");
  app->add_option("--seeds", command->options.seeds,
                  "Number of seeds to average collisions over [1]")
      ->check(whole_option(1, 10000, "1 to 10000 seeds"))
      ->type_name("N");
  app->add_option("--threads", command->options.threads,
                  "Threads for the seeds; timed parts use one [all cores]")
      ->check(whole_option(1, 256, "1 to 256 threads"))
      ->type_name("N");
  app->add_option("--out", command->out, "Folder for report.html and report.md")->type_name("DIR");
  app->add_option("--json", command->json, kJsonHelp)->type_name("FILE");
  return {app, [command] { return reproduce_paper(*command); }};
}

}  // namespace throng
