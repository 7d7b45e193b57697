#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>

#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "apps/output/text_file.h"
#include "apps/process/machine.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/errors.h"
#include "bench/engines/engine.h"
#include "bench/exchange.h"
#include "bench/report.h"
#include "bench/steering.h"
#include "scenes/file/part_volumes.h"

namespace throng {
namespace {

constexpr const char* kBenchFooter = R"(
Other engines update the boxes of all parts and list overlapping boxes. Throng poses people, culls to
or-DOP 26 pairs and reports begin and end events. docs/performance.md states the bias of each comparison.
`cmake --preset bench` builds the engines in.

Examples:
  throng bench --avatars 20000 --density 4
  throng bench --avatars 20000 --crowd plaza
  throng bench --avatars 5000 --engines none --threads 2 --json bench.json
  throng bench --avatars 5000 --age 300 --engines fcl,embree
  throng bench --avatars 1000 --frames 3 --false-positives ordop26
  throng bench --export frames                    then custom_engine frames
  throng bench --check frames/found.csv
  throng bench --model robot.urdf --avatars 500 --frames 3 --false-positives
  throng bench --steering)";

// Longest wait after a signal: frames of the slower engines take this long.
constexpr std::chrono::milliseconds kPatience{700};

constexpr int kStride = 20;  // steps between two frames; few frames then represent a crowd

struct BenchCommand {
  bench::BenchOptions options;
  std::string crowd = "square";
  std::optional<double> density;
  std::string engines = "all";
  std::string simd = "best";
  std::string pair_search = "grid";
  std::string json;
  std::string csv;
  std::string false_positives;
  std::string exports;  // a folder
  std::string check;    // a file
  int aged_frames = 0;
  bool steering = false;
  Option* avatars = nullptr;
  Option* frames = nullptr;

  bool measures_engines() const {
    return !steering && false_positives.empty() && exports.empty() && check.empty() &&
           aged_frames == 0;
  }
};

std::vector<std::string> known_engines() {
  std::vector<std::string> names;
  for (const bench::EngineKind& kind : bench::engine_kinds()) names.emplace_back(kind.name);
  return names;
}

std::vector<std::string> engines_of(const std::string& list) {
  std::vector<std::string> known = known_engines();
  if (list == "all") return known;
  if (list == "none") return {};
  std::vector<std::string> chosen;
  for (size_t begin = 0; begin <= list.size();) {
    const size_t end = std::min(list.find(',', begin), list.size());
    chosen.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  for (const std::string& name : chosen)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError("--engines", fmt::format("all, none or some of {}", fmt::join(known, ",")),
                       fmt::format("'{}'{}", name, did_you_mean(name, known)));
  return chosen;
}

OpenOutputs opened_outputs(const BenchCommand& command) {
  OutputPlan plan;
  plan.reads("the model", command.options.model);
  plan.writes_json(command.json);
  plan.writes({.option = "--csv", .path = command.csv, .mode = WriteMode::kAppended});
  plan.fills("--export", command.exports, bench::exported_files());
  return plan.open();
}

struct Measured {
  std::string text;
  std::string json;
  std::string csv;
  bool is_valid = true;
};

/// Progress on a terminal, redrawn in one line; last() reports it when the measurement is stopped.
class ProgressLine {
 public:
  void show_progress(const std::string& what) {
    const std::lock_guard lock(mutex_);
    last_ = what;
    if (terminal_) print_message("\r\033[K{}", what);
  }
  std::string last() {
    const std::lock_guard lock(mutex_);
    if (terminal_) print_message("\r\033[K");
    return last_;
  }

 private:
  std::mutex mutex_;
  std::string last_;
  const bool terminal_ = isatty(STDERR_FILENO) != 0;
};

Measured measure_steering(const BenchCommand& command, const bench::Progress& progress) {
  bench::SteeringBenchOptions options;
  if (command.avatars->is_given()) options.counts = {command.options.avatars};
  if (command.frames->is_given()) options.steps = command.options.frames;
  options.per_m2 = command.options.per_m2;
  options.threads = command.options.threads;
  options.seed = command.options.seed;
  options.simd = command.options.simd;
  const auto rows = bench::measure_steering(options, progress);
  return {bench::to_text(rows, options, cpu_name()), bench::to_json(rows, options, cpu_name()), {}};
}

Measured measure_parts(const BenchCommand& command, const bench::Progress& progress) {
  bench::BenchOptions options = command.options;
  const std::unique_ptr<bench::Crowd> crowd = bench::make_crowd(options);
  const auto result =
      bench::count_false_positives(*crowd, bench::project_volumes(),
                                   {options.frames, kStride, command.false_positives}, progress);
  const auto misses = [](const bench::VolumeReport& volume) { return volume.missed > 0; };
  return {bench::to_text(result),
          bench::to_json(result, command.options),
          {},
          std::none_of(result.volumes.begin(), result.volumes.end(), misses)};
}

/// Exports fewer people and frames by default than other measurements, for human readers.
Measured export_frames(const BenchCommand& command, const bench::Progress& progress) {
  bench::BenchOptions options = command.options;
  if (!command.avatars->is_given()) options.avatars = 1000;
  if (!command.frames->is_given()) options.frames = 3;
  return {bench::to_text(bench::export_frames(options, kStride, command.exports, progress),
                         command.exports),
          {},
          {}};
}

Measured check_pairs(const BenchCommand& command) {
  const bench::PairCheck judged = bench::check_pairs(command.check);
  return {bench::to_text(judged), {}, {}, judged.agrees()};
}

Measured measure_ageing(const BenchCommand& command, const bench::Progress& progress) {
  const auto result = bench::age(command.options, command.aged_frames, progress);
  return {bench::to_text(result),
          bench::to_json(result, command.options, {cpu_name(), throng::peak_rss_bytes()}),
          {},
          result.aged_work == result.fresh_work};
}

/// Also returns the frames measured before a signal; empty if there were none.
Measured measure_engines(const BenchCommand& command, const bench::Progress& progress) {
  const bench::BenchResult result =
      bench::compare(command.options, progress, StopSignal::requested);
  if (result.options.frames == 0) return {};
  const bench::MachineLine machine{cpu_name(), throng::peak_rss_bytes()};
  const auto agrees = [](const bench::EngineResult& engine) { return engine.agrees; };
  return {bench::to_text(result, machine), bench::to_json(result, machine), bench::to_csv(result),
          std::all_of(result.engines.begin(), result.engines.end(), agrees)};
}

Measured measured(const BenchCommand& command, const bench::Progress& progress) {
  if (command.steering) return measure_steering(command, progress);
  if (!command.exports.empty()) return export_frames(command, progress);
  if (!command.check.empty()) return check_pairs(command);
  if (!command.false_positives.empty()) return measure_parts(command, progress);
  if (command.aged_frames > 0) return measure_ageing(command, progress);
  return measure_engines(command, progress);
}

int report(const BenchCommand& command, const Measured& result) {
  print_unless_json(command.json, result.text);
  write_json_output(command.json, result.json);
  if (!command.csv.empty()) {
    std::error_code error;
    const bool is_new = std::filesystem::file_size(command.csv, error) == 0 && !error;
    append_text(command.csv, (is_new ? bench::csv_header() : "") + result.csv);
  }
  return result.is_valid ? kExitSuccess : kExitCheckFailed;
}

int stopped(const BenchCommand& command, const Measured& result, const std::string& progress) {
  print_message(
      "stopped by {}{}{}; {}\n", StopSignal::name(), progress.empty() ? "" : " after ", progress,
      result.text.empty() ? "no measurement was finished" : "finished measurements follow");
  if (!result.text.empty()) report(command, result);
  return StopSignal::exit_code();
}

int measure(BenchCommand& command) {
  bench::BenchOptions& options = command.options;
  options.engines = engines_of(command.engines);
  if (command.crowd == "plaza" && !options.model.empty())
    throw InputError("--model", "none with --crowd plaza: the scene has its own", options.model);
  if (command.crowd == "plaza" && command.density)
    throw InputError("--density", "none with --crowd plaza: the scene has its own",
                     fmt::format("{}", *command.density));
  options.per_m2 = command.density.value_or(1);
  options.crowd = command.crowd == "plaza" ? bench::CrowdKind::kPlaza : bench::CrowdKind::kSquare;
  options.simd = resolved(*simd_target_of(command.simd));
  options.pair_search = pair_search_of(command.pair_search).value();
  const StopSignal stop;
  const OpenOutputs outputs = opened_outputs(command);  // before minutes of measuring
  const auto result = std::make_shared<Measured>();
  const auto line = std::make_shared<ProgressLine>();
  const bool done = finishes_before_signal(
      [command, result, line] {
        *result = measured(command, [&](const std::string& what) { line->show_progress(what); });
      },
      kPatience);
  const std::string last = line->last();
  if (!done) return stopped(command, {}, last);
  return StopSignal::requested() && command.measures_engines() ? stopped(command, *result, last)
                                                               : report(command, *result);
}

void add_options(CommandOptions& app, BenchCommand& command) {
  bench::BenchOptions& options = command.options;
  command.avatars = app.add_option("--avatars", options.avatars, "Number of people [20000]")
                        ->check(whole_option(2, 1'000'000, "a whole number from 2 to 1000000"))
                        ->type_name("N");
  app.add_option("--density", command.density, "People per square metre [1]")
      ->check(number_option(0, 20, true, "a density above 0, at most 20 per m2"))
      ->type_name("D");
  auto* crowd =
      app.add_option(
             "--crowd", command.crowd,
             "Motion; square: all walk straight on; plaza: agents steer, density of the scene "
             "[square]")
          ->check(name_option({"square", "plaza"}))
          ->type_name("NAME");
  auto* model = app.add_option("--model", options.model, "URDF of the bodies [the bundled adult]")
                    ->type_name("URDF");
  command.frames = app.add_option("--frames", options.frames,
                                  "Number of measured frames, after 3 of warm-up [20]")
                       ->check(whole_option(1, 100'000, "a whole number from 1 to 100000"))
                       ->type_name("N");
  app.add_option("--threads", options.threads, "Threads of Throng and of engines with threads [1]")
      ->check(whole_option(1, 256, "a whole number from 1 to 256"))
      ->type_name("N");
  auto* engines = app.add_option("--engines", command.engines,
                                 "Engines to compare: all, none, or a list like fcl,embree [all]")
                      ->type_name("LIST");
  app.add_option("--seed", options.seed, "Random seed of the crowd [1]")
      ->check(whole_option(0, INT64_MAX, "a whole number from 0"))
      ->type_name("N");
  app.add_option("--simd", command.simd, "Vector instructions [best]")
      ->check(name_option(simd_target_names()))
      ->type_name("TARGET");
  auto* search = app.add_option("--pair-search", command.pair_search,
                                "Broad phase: grid, sweep or brute [grid]")
                     ->check(name_option(pair_search_names()))
                     ->type_name("NAME");
  auto* age = app.add_option("--age", command.aged_frames,
                             "Compare new search structures with ones updated over N frames [300]")
                  ->check(whole_option(1, 100'000, "a whole number from 1 to 100000"))
                  ->type_name("N");
  age->expected(0, 1)->default_str("300");
  auto* parts = app.add_option("--false-positives", command.false_positives,
                               "Measure false positives of every volume, and per part of VOLUME "
                               "[ordop26]")
                    ->check(name_option(volume_names()))
                    ->type_name("VOLUME")
                    ->excludes(age);
  parts->expected(0, 1)->default_str("ordop26");
  auto* json = app.add_option("--json", command.json, kJsonHelp)->type_name("FILE");
  auto* csv = app.add_option("--csv", command.csv, "Append a row per engine to this file")
                  ->type_name("FILE");
  auto* exports =
      app.add_option("--export", command.exports,
                     "Write frames of boxes, poses, shapes and true pairs, for a custom "
                     "engine [1000 people, 3 frames]")
          ->type_name("DIR");
  auto* check =
      app.add_option("--check", command.check,
                     "Check the pairs of a custom engine, a file in the folder of --export")
          ->type_name("FILE");
  for (Option* each : {exports, check})
    each->excludes(age)->excludes(parts)->excludes(csv)->excludes(json);
  exports->excludes(check);
  app.add_flag(
         "--steering", command.steering,
         "Measure a step of each steering model, with 1000, 10000 and 100000 people or --avatars")
      ->excludes(age)
      ->excludes(parts)
      ->excludes(crowd)
      ->excludes(engines)
      ->excludes(search)
      ->excludes(csv)
      ->excludes(exports)
      ->excludes(check)
      ->excludes(model);
}

}  // namespace

Command add_bench_command(CommandLine& parent) {
  CommandOptions* app =
      parent.add_subcommand("bench", "Measure Throng and the other engines that it was built with");
  app->footer(kBenchFooter);
  const auto command = std::make_shared<BenchCommand>();
  add_options(*app, *command);
  return {app, [command] { return measure(*command); }};
}

}  // namespace throng
