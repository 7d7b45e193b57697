#include "bench/steering.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "bench/version_json.h"
#include "crowd/crowd.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"

namespace throng::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr double kWarmUp_s = 2;
constexpr int kDecisions = 2'000'000;
/// Equals the decision period: each step is one decision and one move.
constexpr double kStep_s = 0.1;
/// Step of a run: a third of the people decide in a frame, and all move.
constexpr double kFrame_s = 1.0 / 30;

struct Reference {
  int people;
  double ms;
};
/// RVO2 with its k-d tree and ten neighbours, one core: ms per step. Measured on another machine:
/// Debian has no package of RVO2, so it cannot run here.
constexpr Reference kRvo2[] = {{100, 0.061}, {1'000, 1.08}, {10'000, 12.8}, {100'000, 142}};
constexpr const char* kSource =
    "RVO2's published code, k-d tree, 10 neighbours, one core of another machine";

std::optional<double> rvo2_ms(int people) {
  for (const Reference& each : kRvo2)
    if (each.people == people) return each.ms;
  return std::nullopt;
}

/// People start at random positions on the square and cross it from side to side.
Scene square(int people, double per_m2, uint64_t seed) {
  const double edge_m = std::sqrt(people / per_m2);
  const double rim_m = 0.05 * edge_m + 0.6;
  Scene scene;
  scene.seed = seed;
  scene.ground = {{0, 0}, {edge_m, edge_m}};
  const Rectangle west{{0, 0}, {rim_m, edge_m}}, east{{edge_m - rim_m, 0}, {edge_m, edge_m}};
  const Rectangle south{{0, 0}, {edge_m, rim_m}}, north{{0, edge_m - rim_m}, {edge_m, edge_m}};
  const std::pair<Rectangle, Rectangle> routes[] = {
      {west, east}, {east, west}, {south, north}, {north, south}};
  int left = people;
  for (size_t i = 0; i < std::size(routes); ++i) {
    Group group;
    group.count = left / static_cast<int>(std::size(routes) - i);
    left -= group.count;
    group.spawn = scene.ground;
    group.goals = {Area(routes[i].first), Area(routes[i].second)};
    scene.groups.push_back(group);
  }
  return scene;
}

struct Walk {
  int people = 0;  ///< number that found a place
  TimeStats ms;    ///< time per step
  double sweeps = 0;
};

Walk walk(SteeringKind model, NavigationMap& navigation, const SpawnResult& spawned, double step_s,
          const SteeringBenchOptions& options, Workers& workers) {
  throng::Crowd crowd(navigation, spawned.people,
                      {options.seed, step_s, {model, false}, options.simd}, workers);
  for (int step = 0; step * step_s < kWarmUp_s; ++step) crowd.step();
  const SteeringCounters before = crowd.counters();
  const int people = std::max(1, static_cast<int>(spawned.people.size()));
  const int steps = options.steps.value_or(std::clamp(kDecisions / people, 9, 201));
  std::vector<double> times_ms;
  for (int step = 0; step < steps; ++step) {
    const auto start = Clock::now();
    crowd.step();
    times_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  return {static_cast<int>(crowd.population().counters().present), time_stats_of(times_ms),
          static_cast<double>(crowd.counters().all_sweeps - before.all_sweeps) / steps};
}

SteeringRow measure(SteeringKind model, int people, const SteeringBenchOptions& options,
                    Workers& workers) {
  const Scene scene = square(people, options.per_m2, options.seed);
  NavigationMap navigation(scene, workers);
  const SpawnResult spawned = spawn(scene, navigation);
  const Walk decisions = walk(model, navigation, spawned, kStep_s, options, workers);
  SteeringRow row;
  row.model = model;
  row.people = decisions.people;
  row.ms = decisions.ms;
  row.sweeps = decisions.sweeps;
  row.frame_ms = walk(model, navigation, spawned, kFrame_s, options, workers).ms;
  // The reference time is that of one core.
  if (options.threads == 1) row.rvo2_ms = rvo2_ms(row.people);
  return row;
}

}  // namespace

std::vector<SteeringRow> measure_steering(const SteeringBenchOptions& options,
                                          const Progress& progress) {
  Workers workers(options.threads);
  std::vector<SteeringRow> rows;
  for (const SteeringKind model : all_steering_kinds())
    for (const int people : options.counts) {
      progress(fmt::format("{}, {} people", name_of(model), people));
      rows.push_back(measure(model, people, options, workers));
    }
  return rows;
}

std::string to_text(const std::vector<SteeringRow>& rows, const SteeringBenchOptions& options,
                    const std::string& cpu) {
  std::string out;
  append(out,
         "steering: four groups cross a square, {:.4g} per m2, {} thread{}, {} on {}\n"
         "step: all people decide and move; frame: 1/30 s, in which a third of the people decide "
         "and all move\n\n",
         options.per_m2, options.threads, options.threads == 1 ? "" : "s",
         name_of(resolved(options.simd)), cpu);
  append(out, "  {:<21}{:>8}{:>10}{:>8}{:>8}{:>11}{:>8}{:>10}{:>8}{:>10}{:>8}\n", "model", "people",
         "step: min", "median", "p95", "us/person", "sweeps", "frame ms", "p95", "RVO2 step",
         "ratio");
  for (const SteeringRow& row : rows) {
    append(out, "  {:<21}{:>8}{:>10.3f}{:>8.3f}{:>8.3f}{:>11.3f}{:>8.1f}{:>10.3f}{:>8.3f}",
           name_of(row.model), row.people, row.ms.min, row.ms.median, row.ms.p95,
           1e3 * row.ms.median / std::max(row.people, 1), row.sweeps, row.frame_ms.median,
           row.frame_ms.p95);
    if (row.rvo2_ms)
      append(out, "{:>10.4g}{:>8.2f}\n", *row.rvo2_ms, *row.rvo2_ms / row.ms.median);
    else
      append(out, "{:>10}{:>8}\n", "-", "-");
  }
  append(out,
         "\n  RVO2: {}. RVO2 did not run here:\n  read the ratio as an order of magnitude; "
         "docs/performance.md states the bias.\n",
         kSource);
  return out;
}

std::string to_json(const std::vector<SteeringRow>& rows, const SteeringBenchOptions& options,
                    const std::string& cpu) {
  Json json{{"throng", version_json()},
            {"density_per_m2", options.per_m2},
            {"threads", options.threads},
            {"seed", options.seed},
            {"simd", std::string(name_of(resolved(options.simd)))},
            {"cpu", cpu},
            {"rvo2_source", kSource}};
  json["steering"] = Json::array();
  for (const SteeringRow& row : rows)
    json["steering"].push_back({{"model", std::string(name_of(row.model))},
                                {"people", row.people},
                                {"ms", row.ms.median},
                                {"min_ms", row.ms.min},
                                {"p95_ms", row.ms.p95},
                                {"sweeps", row.sweeps},
                                {"frame_ms", row.frame_ms.median},
                                {"frame_p95_ms", row.frame_ms.p95},
                                {"rvo2_ms", row.rvo2_ms ? Json(*row.rvo2_ms) : Json()}});
  return json.dump(2) + "\n";
}

}  // namespace throng::bench
