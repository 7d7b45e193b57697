#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "analysis/measures/comparison.h"
#include "apps/command.h"
#include "apps/options/run_arguments.h"
#include "apps/output/output_plan.h"
#include "apps/output/text_file.h"
#include "apps/process/progress.h"
#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/figure.h"
#include "bench/version_json.h"
#include "lcm_io/replay/run_source.h"
#include "scenes/run/runner.h"

namespace throng {
namespace {

constexpr const char* kCompareFooter = R"(
A and B are scenes, names from `throng scenes`, recordings or logs. Each is run first, with triangles; a log
is culled again. Options for a recording belong in a scene of `kind: recorded`.

Examples:
  throng compare corridor crossing --seconds 20
  throng compare bottleneck my_bottleneck.yaml --out out/compare --json compare.json
  throng compare before.yaml after.yaml --line 0,-1,0,1)";

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isnan(value) ? Json() : Json(value); }

Json row_json(const MeasureTable& table, const ComparedRow& each) {
  Json json;
  if (each.row.from) {
    json[table.key == "part" ? "density" : table.key] = *each.row.from;
    if (each.row.to) json[(table.key == "part" ? "density" : table.key) + "_to"] = *each.row.to;
  } else {
    json["part"] = each.row.at;
  }
  if (!each.row.which.empty()) json["which"] = each.row.which;
  json["what"] = each.row.what;
  json["a"] = number(each.a);
  json["b"] = number(each.b);
  json["unit"] = each.row.unit;
  return json;
}

Json run_json(const MeasuredRun& run) {
  return {{"name", run.name},
          {"people", run.facts.people},
          {"seconds", run.facts.seconds},
          {"person_s", run.facts.person_s},
          {"sample_s", run.facts.sample_s},
          {"off_area", run.facts.off_area}};
}

/// `{speed_density spacing flow width_use sway accelerations contacts depth}`, each a list of rows
/// with the values of A and of B; null: no value.
std::string comparison_json(const MeasuredRun& a, const MeasuredRun& b) {
  Json json = {{"throng", version_json()}, {"a", run_json(a)}, {"b", run_json(b)}};
  for (size_t i = 0; i < a.tables.size(); ++i) {
    Json rows = Json::array();
    for (const ComparedRow& each : compared_rows(a.tables[i], b.tables[i]))
      rows.push_back(row_json(a.tables[i], each));
    json[a.tables[i].id] = rows;
  }
  return json.dump(2) + "\n";
}

/// Writes report.md and its SVG figures into an existing folder. Throws EnvironmentError.
void write_comparison_report(const MeasuredRun& a, const MeasuredRun& b,
                             const std::filesystem::path& folder) {
  std::string text =
      fmt::format("# {} and {}\n\nWritten by `throng compare --out`.\n\n", a.name, b.name);
  for (const Figure& figure : comparison_figures(a, b)) {
    text +=
        fmt::format("![{0}]({1}.svg)\n\n*{0}.* {2}\n\n", figure.title, figure.id, figure.caption);
    draw(figure, folder);
  }
  text += "```text\n" + comparison_text(a, b) + "```\n";
  write_text(folder / "report.md", text);
}

struct CompareOptions {
  std::string a, b;
  std::string json;
  std::string out;
  std::vector<float> line;  ///< two points, or empty
  RunOptions run;
};

/// The run with triangles, and at most the requested duration.
RunSource source_of(const std::string& name, const CompareOptions& options) {
  RunOptions run = options.run;
  run.exact = true;
  RunSource out = open_run_source(name, run);
  for (const std::string& note : out.notes) print_message("note: {}\n", note);
  return out;
}

std::optional<Passage> chosen_line(const CompareOptions& options) {
  if (options.line.empty()) return {};
  const auto at = [&](size_t i) {
    return Eigen::Vector2d(static_cast<double>(options.line[i]),
                           static_cast<double>(options.line[i + 1]));
  };
  if (at(0) == at(2)) throw InputError("--line", "two points", "the same point twice");
  return Passage{at(0), at(2)};
}

std::optional<MeasuredRun> measured(RunSource source, const CompareOptions& options) {
  SimulationOptions simulated = simulation_options(options.run);
  simulated.motion = std::move(source.motion);
  Simulation simulation(std::move(source.scene), simulated);
  for (const std::string& note : simulation.notes())
    print_message("note: {}: {}\n", simulation.scene().name, note);
  CrowdMeasures measures({.line = chosen_line(options)});
  ProgressBar progress(simulation.scene().name,
                       frame_count(simulation.scene().duration_s, simulation.info().step_s));
  Sink* const sink = &measures;
  const RunSummary summary = run(simulation, {&sink, 1}, [&](const Frame& frame) {
    progress.show(frame.number + 1);
    return !StopSignal::requested();
  });
  if (summary.stopped_early) return {};
  return MeasuredRun{simulation.scene().name, measures.facts(), measures.tables()};
}

/// Notes agents that pass outside a chosen line: its flow does not count them.
void note_passed_outside(const MeasuredRun& run) {
  for (const MeasureTable& table : run.tables) {
    if (table.id != "flow") continue;
    const double outside = table.value("the line", "", "people past its ends");
    if (!(outside > 0)) continue;  // NaN without --line
    print_message(
        "note: {}: {:.0f} of {} people passed outside the line; extend the line, or block the "
        "ground "
        "there with obstacles\n",
        run.name, outside, run.facts.people);
  }
}

int compare(const CompareOptions& options) {
  OutputPlan plan;
  plan.writes_json(options.json);
  plan.fills("--out", options.out, {"report.md", "*.svg"});
  plan.check();
  chosen_line(options);  // throws if it is invalid
  if (!options.out.empty()) require_gnuplot();
  // Load both before the first run: errors in B are reported at once.
  RunSource source_a = source_of(options.a, options);
  RunSource source_b = source_of(options.b, options);
  plan_inputs(source_a.scene, plan);
  plan_inputs(source_b.scene, plan);
  plan.check();
  const StopSignal stop;
  const OpenOutputs outputs = plan.open();
  const std::optional<MeasuredRun> a = measured(std::move(source_a), options);
  const std::optional<MeasuredRun> b = a ? measured(std::move(source_b), options) : std::nullopt;
  if (!b) {
    print_message("stopped by {}: no run was finished\n", StopSignal::name());
    return StopSignal::exit_code();
  }
  for (const MeasuredRun* run : {&*a, &*b}) note_passed_outside(*run);
  print_unless_json(options.json, comparison_text(*a, *b));
  write_json_output(options.json, comparison_json(*a, *b));
  if (!options.out.empty()) {
    write_comparison_report(*a, *b, options.out);
    print_unless_json(options.json, fmt::format("{}/report.md written\n", options.out));
  }
  return kExitSuccess;
}

}  // namespace

Command add_compare_command(CommandLine& parent) {
  CommandOptions* app = parent.add_subcommand(
      "compare", "Compare two crowds: speed, spacing, flow, sway, contacts and their depth");
  app->footer(kCompareFooter);
  const auto options = std::make_shared<CompareOptions>();
  app->add_option("A", options->a, "Scene file, name from `throng scenes`, recording, or log")
      ->required();
  app->add_option("B", options->b, "As A")->required();
  app->add_option("--json", options->json, kJsonHelp)->type_name("FILE");
  app->add_option("--out", options->out, "Folder for report.md and its figures")->type_name("DIR");
  add_run_option(*app, "seconds", options->run);
  app->add_list("--line", options->line, 4, ',', number_option(-1e6, 1e6, false, ""),
                "two points in metres, X,Y,X,Y",
                "Line across which flow is measured, in metres [the narrowest place]")
      ->type_name("X,Y,X,Y");
  add_run_option(*app, "threads", options->run);
  return {app, [options] { return compare(*options); }};
}

}  // namespace throng
