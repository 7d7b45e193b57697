#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include "analysis/studies/ranks.h"
#include "analysis/studies/study_job.h"
#include "analysis/studies/study_options.h"
#include "analysis/studies/study_table.h"
#include "apps/command.h"
#include "apps/output/output_plan.h"
#include "apps/process/progress.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/cores.h"
#include "base/errors.h"
#include "base/figure.h"
#include "base/text.h"
#include "scenes/run/body_tables.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStudyFooter = R"(
A study file:
  scenes: [plaza, my_scene.yaml]
  seeds: {from: 1, to: 10, step: 1}
  seconds: 10
  parameters:
    avatars: [200, 500]
    groups.1.desired_speed_mps.mean: {from: 1.0, to: 1.6, step: 0.2}

Examples:
  throng study study.yaml --out study.csv
  throng study study.yaml --out study.sqlite --plot
  throng study study.yaml --out part_3.csv --shard 3/7
  throng study --merge part_*.csv --out study.csv
  mpirun -n 8 throng study study.yaml --out study.csv

The table has one row per run and is the same, byte for byte, for any number of processes and order of runs.
Measured times go to TABLE.times.csv. TABLE.journal holds finished runs until the table is complete: repeat the
command to resume a stopped study. docs/studies.md describes the files, --columns lists the columns.)";

struct StudyCommand {
  std::string file;
  std::string out;
  std::vector<std::string> merge;
  std::string shard_text;
  std::optional<int> threads;
  bool plot = false;
  bool columns = false;
};

StudyShard shard_of(const std::string& text) {
  if (text.empty()) return {};
  StudyShard shard;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%zu/%zu%c", &shard.index, &shard.count, &rest) != 2 ||
      text.find('-') != std::string::npos || shard.index < 1 || shard.count < shard.index ||
      shard.count > kMaxStudyRuns)
    throw InputError("--shard", "I/N with I from 1 to N, as in 3/7", fmt::format("'{}'", text));
  return shard;
}

fs::path plot_folder(const fs::path& table) {
  fs::path folder = table;
  folder += ".plots";
  return folder;
}

void draw_plots(const fs::path& out, const StudyTable& table) {
  const fs::path folder = plot_folder(out);
  const std::vector<Figure> figures = study_figures(table);
  for (const Figure& figure : figures) draw(figure, folder);
  print_message("{} in {}\n", counted(figures.size(), "picture"), folder.string());
}

OutputPlan planned_outputs(const StudyCommand& options) {
  OutputPlan plan;
  plan.writes({.option = "--out", .path = options.out});
  plan.writes({.option = "--out", .path = times_of(options.out)});
  if (options.merge.empty())
    plan.writes({.option = "--out", .path = journal_of(options.out), .mode = WriteMode::kAppended});
  if (options.plot) {
    require_gnuplot();
    plan.fills("--plot", plot_folder(options.out), {"*.svg"});
  }
  return plan;
}

/// Whether the pattern `part_*.csv` also matched the times of another table.
bool is_times_of_another(const std::string& name, const std::vector<std::string>& all) {
  return std::any_of(all.begin(), all.end(),
                     [&](const std::string& table) { return times_of(table) == fs::path(name); });
}

int merge(const StudyCommand& options) {
  if (!options.file.empty())
    throw InputError("--merge", "only tables", fmt::format("the study file '{}'", options.file));
  table_kind(options.out);
  OutputPlan plan = planned_outputs(options);
  std::vector<std::pair<std::string, StudyTable>> tables, times;
  for (const std::string& name : options.merge) {
    if (is_times_of_another(name, options.merge)) continue;
    plan.reads("a table of --merge", name);
    tables.emplace_back(name, read_table(name));
    const fs::path own_times = times_of(name);
    std::error_code ignored;
    if (fs::is_regular_file(own_times, ignored))
      times.emplace_back(own_times.string(), read_table(own_times));
  }
  const StudyTable table = merged(tables);
  const OpenOutputs outputs = plan.open();
  write_table(options.out, table);
  if (times.size() == tables.size()) write_table(times_of(options.out), merged(times));
  print_message("{} of {} in {}\n", counted(table.rows.size(), "run"),
                counted(tables.size(), "table"), options.out);
  if (options.plot) draw_plots(options.out, table);
  return kExitSuccess;
}

bool goes_on() { return !StopSignal::requested(); }

/// Runs of the command with their progress on the terminal.
class Work {
 public:
  Work(const StudyCommand& options, const StudyPlan& plan, const StudyShard& shard)
      : options_(options), job_(plan, shard, options.out) {
    if (job_.finished() > 0)
      print_message("note: {} of {} runs were done before; resuming\n",
                    job_.requested() - job_.left(), job_.requested());
    if (job_.left() > 0) {
      const std::string label = fs::path(options.file).stem().string();
      progress_.emplace(label, static_cast<int64_t>(job_.left()), "runs");
      progress_->show(0);
    }
  }

  std::optional<size_t> next() { return StopSignal::requested() ? std::nullopt : job_.next(); }
  void return_run(size_t run) { job_.return_run(run); }
  void take(const StudyRow& row) { show(job_.add(row)); }
  void run(int threads) {
    run_job(
        job_, threads, [this](size_t done) { show(done); }, goes_on);
  }

  int end() {
    progress_.reset();
    if (!job_.is_complete()) {
      print_message("stopped{}: {} of {} runs are done; repeat the command to resume\n",
                    StopSignal::requested() ? fmt::format(" by {}", StopSignal::name()) : "",
                    job_.finished(), job_.requested());
      return StopSignal::requested() ? StopSignal::exit_code() : kExitEnvironment;
    }
    job_.write();
    print_message("{} in {}\n", counted(job_.requested(), "run"), options_.out);
    if (options_.plot) draw_plots(options_.out, job_.table());
    return kExitSuccess;
  }

 private:
  void show(size_t done) {
    const std::lock_guard lock(mutex_);
    progress_->show(static_cast<int64_t>(done));
  }

  const StudyCommand& options_;
  StudyJob job_;
  std::mutex mutex_;
  std::optional<ProgressBar> progress_;
};

StudyPlan plan_of(const StudyCommand& options) { return StudyPlan(read_study(options.file)); }

void print_notes(const StudyPlan& plan) {
  constexpr size_t kMaxNotes = 8;  // the rest is in the column plan_growth
  const std::vector<std::string>& notes = plan.notes();
  const size_t shown = std::min(notes.size(), kMaxNotes);
  for (size_t i = 0; i < shown; ++i) print_message("note: {}\n", notes[i]);
  if (notes.size() > shown)
    print_message("note: and {} more\n", counted(notes.size() - shown, "note"));
}

int study_alone(const StudyCommand& options) {
  const StudyShard shard = shard_of(options.shard_text);
  const StudyPlan plan = plan_of(options);
  OutputPlan outputs = planned_outputs(options);
  outputs.reads("the study", options.file);
  for (const StudyScene& scene : plan.study().scenes) outputs.reads("a scene", scene.file);
  print_notes(plan);
  const StopSignal stop;
  const OpenOutputs open = outputs.open();
  Work work(options, plan, shard);
  work.run(options.threads.value_or(core_count()));
  return work.end();
}

/// Rank 0: distributes runs, writes the journal, and also runs.
int run_leader(const StudyCommand& options, Ranks& ranks, const StudyPlan& plan) {
  OutputPlan outputs = planned_outputs(options);
  outputs.reads("the study", options.file);
  print_notes(plan);
  const StopSignal stop;
  const OpenOutputs open = outputs.open();
  Work work(options, plan, {});
  std::atomic<bool> is_busy{true};
  std::exception_ptr failure;
  std::thread own([&] {
    try {
      const int threads = options.threads.value_or(1);
      run_all({plan, [&work] { return work.next(); },
               [&work](const StudyRow& row) { work.take(row); }, goes_on},
              1, threads);
    } catch (...) {
      failure = std::current_exception();
    }
    is_busy = false;
  });
  const auto take = [&](const std::string& line) {
    StudyRow row;
    if (!read_line(line.substr(0, line.size() - 1), row))
      throw EnvironmentError(
          "mpirun: a rank sent an invalid result; use the same version of Throng on all");
    work.take(row);
  };
  try {
    ranks.run_leader({[&] { return work.next(); }, take, [&](size_t run) { work.return_run(run); },
                      [&] { return is_busy.load(); }});
  } catch (...) {
    own.detach();  // the process ends with this rank
    throw;
  }
  own.join();
  if (failure) std::rethrow_exception(failure);
  return work.end();
}

int study_in_ranks(const StudyCommand& options) {
  if (!options.shard_text.empty())
    throw InputError("--shard", "no --shard under mpirun, which distributes the runs", "one");
  Ranks ranks;
  // Errors in the study are reported once, by rank 0.
  if (ranks.rank() != 0) ranks.wait_for_first();
  const StudyPlan plan = plan_of(options);
  if (ranks.rank() == 0) {
    ranks.wait_for_first();
    return run_leader(options, ranks, plan);
  }
  const StopSignal stop;
  const auto tables = std::make_shared<BodyTables>();
  ranks.run_follower([&](size_t run) -> std::optional<std::string> {
    const std::optional<StudyRow> row =
        run_one(plan, run, options.threads.value_or(1), tables, goes_on);
    return row ? std::optional(line_of(*row)) : std::nullopt;
  });
  return StopSignal::requested() ? StopSignal::exit_code() : kExitSuccess;
}

void print_columns(const std::vector<StudyMeasure>& columns) {
  constexpr std::array kKinds = {"integer", "number", "text"};
  for (const StudyMeasure& column : columns)
    print_result("{:<32} {:<7} {}\n", column.name, kKinds[static_cast<size_t>(column.kind)],
                 column.meaning);
}

/// Columns of the table, a blank line, then columns of TABLE.times.csv.
int print_columns() {
  using Kind = StudyMeasure::Kind;
  print_columns({{"run", Kind::kInteger, "number of the run, from 1"},
                 {"runs", Kind::kInteger, "number of runs of the study"},
                 {"study", Kind::kText, "hash of all that the study asks for"},
                 {"scene", Kind::kText, "scene of the run, as in the study file"},
                 {"seed", Kind::kInteger, "seed of the run"},
                 {"OPTION", Kind::kText,
                  fmt::format("one column per option in the study file: `{}`",
                              fmt::join(study_option_names(), "`, `"))},
                 {"PARAMETER", Kind::kText, "one column per parameter in the study file"}});
  print_columns(study_measures());
  print_result("\n");
  print_columns(study_times());
  return kExitSuccess;
}

int study(const StudyCommand& options) {
  if (options.columns) return print_columns();
  if (options.out.empty()) throw InputError("--out", "a table to write", "none");
  if (!options.merge.empty()) return merge(options);
  if (options.file.empty()) throw InputError("study", "a study file, or --merge", "neither");
  table_kind(options.out);
  return Ranks::are_launched() ? study_in_ranks(options) : study_alone(options);
}

}  // namespace

Command add_study_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand(
      "study", "Run scenes x seeds x parameters; write a table with a row per run");
  app->footer(kStudyFooter);
  const auto options = std::make_shared<StudyCommand>();
  app->add_option("FILE", options->file, "Study file");
  app->add_option("--out", options->out, "Table to write: NAME.csv or NAME.sqlite")
      ->type_name("FILE");
  app->add_option("--threads", options->threads,
                  "Concurrent runs; threads per run if fewer runs are left [all cores]")
      ->check(whole_option(1, 256, "1 to 256 threads"))
      ->type_name("N");
  app->add_option("--shard", options->shard_text,
                  "Run only every N-th run, from the I-th on; for job arrays")
      ->type_name("I/N");
  app->add_option("--merge", options->merge, "Join these tables of all shards instead")
      ->expected(1, 100'000)
      ->type_name("FILE");
  app->add_flag("--plot", options->plot,
                "Draw each measure against each parameter, in TABLE.plots");
  app->add_flag("--columns", options->columns,
                "Print the columns of the tables with their meanings")
      ->excludes("FILE")
      ->excludes("--out")
      ->excludes("--merge");
  return {app, [options] { return study(*options); }};
}

}  // namespace throng
