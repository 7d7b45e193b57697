#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>

#include "apps/command.h"
#include "apps/commands/validation_report.h"
#include "apps/output/output_plan.h"
#include "apps/output/text_file.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/cores.h"
#include "base/errors.h"
#include "base/figure.h"
#include "base/workers.h"

namespace throng {
namespace {

constexpr const char* kValidateFooter = R"(
Runs the single-floor tests of RiMEA 4.1.0, IMO MSC.1/Circ.1533 and ISO 20414; docs/validation.md shows them
with figures. Exit code 1 if any test fails. Ctrl-C stops it; finished verdicts are printed.
--empirical compares the simulated crowd, with default parameters, with recorded people instead.

Examples:
  throng validate
  throng validate --only rimea_4 --out out/validation
  throng validate --json validation.json
  throng validate --empirical --only doors --out out/doors
  throng validate --empirical --seeds 5)";

struct ValidateOptions {
  std::string out;
  std::string json;
  std::string recordings;
  std::vector<std::string> only;
  bool empirical = false;
  uint64_t seed = 1;
  uint64_t seeds = 1;
  std::string steering{name_of(SteeringRule{}.model)};
  int threads = core_count();
};

std::vector<std::string> test_ids() {
  std::vector<std::string> ids;
  for (const auto* tests : {&validation::all_tests(), &validation::empirical_tests()})
    for (const validation::Test& test : *tests)
      ids.insert(ids.end(), test.ids.begin(), test.ids.end());
  return ids;
}

std::vector<ValidationRun> chosen(const ValidateOptions& options) {
  std::vector<ValidationRun> runs;
  const auto named = [&](const validation::Test& test) {
    return std::any_of(options.only.begin(), options.only.end(),
                       [&](const std::string& id) { return test.has(id); });
  };
  for (const bool empirical : {false, true})
    for (const validation::Test& test :
         empirical ? validation::empirical_tests() : validation::all_tests())
      if (options.only.empty() ? empirical == options.empirical : named(test))
        runs.push_back({&test, {}});
  return runs;
}

/// Shared with the thread that runs the tests, which may outlive this command.
struct Session {
  std::mutex mutex;
  std::vector<ValidationRun> runs;
  uint64_t seeds = 1;

  /// Finished tests in their order, with the seeds that are done.
  std::vector<ValidationRun> finished() {
    const std::lock_guard lock(mutex);
    std::vector<ValidationRun> out;
    for (const ValidationRun& run : runs) {
      if (run.seeds.empty()) continue;
      ValidationRun& done = out.emplace_back(run);
      std::sort(done.seeds.begin(), done.seeds.end(),
                [](const auto& a, const auto& b) { return a.seed < b.seed; });
      done.outcome = validation::across_seeds(done.seeds);
    }
    return out;
  }
  size_t done() {
    const std::lock_guard lock(mutex);
    size_t count = 0;
    for (const ValidationRun& run : runs) count += run.seeds.size();
    return count;
  }
  size_t run_count() const { return runs.size() * seeds; }
};

void run_all(Session& session, const validation::Conditions& conditions, int threads) {
  Workers workers(threads);
  workers.for_blocks(static_cast<int>(session.run_count()), [&](int index, int) {
    const auto i = static_cast<size_t>(index);
    ValidationRun& run = session.runs[i / session.seeds];
    validation::Conditions run_conditions = conditions;
    run_conditions.seed += i % session.seeds;
    const auto start = std::chrono::steady_clock::now();
    validation::SeedOutcome done{run_conditions.seed, run_test(*run.test, run_conditions), 0};
    done.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::lock_guard lock(session.mutex);
    print_message("{:<9} {}{} ({:.1f} s)\n", run.test->ids.front(),
                  session.seeds > 1 ? fmt::format("seed {}: ", run_conditions.seed) : "",
                  name_of(done.outcome.verdict()), done.wall_s);
    run.seeds.push_back(std::move(done));
  });
}

/// Reports missing recordings before any test runs.
void require_recordings(const std::string& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  for (const std::string& name : validation::recording_files())
    if (!std::filesystem::is_regular_file(std::filesystem::path(folder) / name, ignored))
      throw InputError("--recordings", fmt::format("a folder with {}", name),
                       fmt::format("'{}' without it", folder));
}

int validate(const ValidateOptions& options) {
  const StopSignal stop;
  require_recordings(options.recordings);
  OutputPlan plan;
  plan.writes_json(options.json);
  plan.fills("--out", options.out, {"report.md", "*.svg"});
  if (!options.out.empty()) require_gnuplot();
  const OpenOutputs outputs = plan.open();
  const auto session = std::make_shared<Session>();
  session->runs = chosen(options);
  session->seeds = options.seeds;
  const validation::Conditions conditions{steering_kind_of(options.steering).value(), options.seed,
                                          options.recordings};
  const bool all = finishes_before_signal(
      [session, conditions, threads = options.threads] { run_all(*session, conditions, threads); });
  const std::vector<ValidationRun> runs = session->finished();
  if (!all)
    print_message("stopped by {}: {} of {} experiments were finished\n", StopSignal::name(),
                  session->done(), session->run_count());
  print_unless_json(options.json, verdict_table(runs));
  write_json_output(options.json, validation_json(runs, !all));
  if (!options.out.empty()) {
    write_validation_report(runs, options.out);
    print_unless_json(options.json, fmt::format("{}/report.md written\n", options.out));
  }
  if (!all) return StopSignal::exit_code();
  return count_of(runs).failed == 0 ? kExitSuccess : kExitCheckFailed;
}

}  // namespace

Command add_validate_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand(
      "validate", "Run the RiMEA, IMO and ISO 20414 tests of pedestrian motion");
  app->footer(kValidateFooter);
  const auto options = std::make_shared<ValidateOptions>();
  app->add_option("--out", options->out, "Folder for report.md and its figures")->type_name("DIR");
  app->add_option("--json", options->json, kJsonHelp)->type_name("FILE");
  app->add_option("--only", options->only, "Run only these tests: rimea_4, imo_8, doors, ...")
      ->transform([](std::string& id) { id = validation::normal_id(id); })
      ->check(name_option(test_ids()))
      ->type_name("ID");
  app->add_flag("--empirical", options->empirical,
                "Compare with recorded people instead of the standards' tests");
  app->add_option("--steering", options->steering,
                  fmt::format("Steering model: {} [{}]", steering_choices(), options->steering))
      ->check(name_option(steering_names()))
      ->type_name("MODEL");
  app->add_option(
         "--recordings", options->recordings,
         "Folder of recordings for --empirical, see docs/recordings.md; without it comparisons "
         "that need them are skipped")
      ->type_name("DIR");
  app->add_option("--seed", options->seed, "First random seed [1]")
      ->check(whole_option(1, INT64_MAX / 1000, "a whole number from 1"))
      ->type_name("N");
  app->add_option("--seeds", options->seeds,
                  "Number of seeds per test; a test must pass with each [1]")
      ->check(whole_option(1, 1000, "1 to 1000 seeds"))
      ->type_name("N");
  app->add_option("--threads", options->threads, "Concurrent tests [all cores]")
      ->check(whole_option(1, 256, "1 to 256 threads"))
      ->type_name("N");
  return {app, [options] { return validate(*options); }};
}

}  // namespace throng
