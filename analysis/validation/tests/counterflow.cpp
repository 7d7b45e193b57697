// IMO 8: two rooms, a corridor, and people who want through it the other way.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "analysis/validation/trial.h"
#include "analysis/validation/validation.h"

namespace throng::validation {
namespace {

constexpr int kAgainst[] = {0, 10, 50, 100};
constexpr double kPassedWithin_s = 600;

struct Crossing {
  double last_s = 0;  ///< when the last of the hundred entered the other room
  size_t arrived = 0;
  size_t arrived_against = 0;
};

Crossing cross(SteeringKind model, int against, uint64_t seed, Outcome& outcome) {
  Plan plan("counterflow", {{0, 0}, {30, 10}}, {model}, seed);
  plan.wall(10, 0, 20, 4);
  plan.wall(10, 6, 20, 10);
  plan.people(100, {{0, 0}, {8, 10}}, {{{28, 0}, {30, 10}}});
  if (against > 0) plan.people(against, {{22, 0}, {30, 10}}, {{{0, 0}, {2, 10}}});
  Trial trial(plan);
  Gate east(Gate::Along::kX, 20, 0, 10);
  Gate west(Gate::Along::kX, 10, 0, 10, false);
  while (trial.step(kPassedWithin_s)) {
    east.watch(trial);
    west.watch(trial);
  }
  note(outcome, trial);
  const auto of_group = [&](const Gate& gate, uint16_t group) {
    return static_cast<size_t>(
        std::count_if(gate.passages().begin(), gate.passages().end(),
                      [&](const Gate::Passage& p) { return trial.group(p.id) == group; }));
  };
  Crossing out;
  out.arrived = of_group(east, 0);
  out.arrived_against = of_group(west, 1);
  for (const Gate::Passage& passage : east.passages())
    if (trial.group(passage.id) == 0) out.last_s = std::max(out.last_s, passage.time_s);
  return out;
}

Outcome counterflow(const Conditions& conditions) {
  constexpr uint64_t kSeeds = 3;
  Outcome outcome;
  bool everybody = true, grows = true;
  double before_s = 0;
  std::string list, data;
  for (const int against : kAgainst) {
    double sum_s = 0;
    std::string runs;
    for (uint64_t run = 0; run < kSeeds; ++run) {
      const uint64_t seed = conditions.seed_of_run(run, kSeeds);
      const Crossing crossing = cross(conditions.model, against, seed, outcome);
      everybody = everybody && crossing.arrived == 100 &&
                  crossing.arrived_against == static_cast<size_t>(against);
      sum_s += crossing.last_s;
      runs += fmt::format(" {:.2f}", crossing.last_s);
    }
    const double mean_s = sum_s / kSeeds;
    grows = grows && mean_s > before_s;
    before_s = mean_s;
    list += fmt::format("{}{:.0f} s against {}", list.empty() ? "" : ", ", mean_s, against);
    data += fmt::format("{} {:.2f}{}\n", against, mean_s, runs);
  }
  outcome.passed = everybody && grows;
  outcome.measured =
      fmt::format("{} (means of {} seeds); {}", list, kSeeds,
                  everybody ? "everybody arrives" : "not everybody arrived within 600 s");
  outcome.figures.push_back(
      {"imo_8", "IMO 8: how long a hundred take against others", "",
       "$data << EOD\n" + data +
           fmt::format(
               "EOD\nset grid\nset key top left\nset xrange [-5:105]\nset yrange "
               "[0:*]\nset xlabel 'people who come the other way'\nset ylabel 'last of the "
               "hundred in the other room, s'\nplot for [i=3:5] $data using 1:i with points "
               "pointtype 6 linecolor rgb '#999999' title (i == 3 ? 'a seed each' : ''), "
               "$data using 1:2 with linespoints linewidth 2 pointtype 7 linecolor rgb "
               "'{}' title 'mean'\n",
               kFigureColours[0])});
  return outcome;
}

}  // namespace

std::vector<Test> counterflow_tests() {
  return {{{"imo_8", "iso_6"},
           {"IMO 8: counterflow", "ISO 20414 6: counterflow"},
           "Two rooms of 10 m x 10 m, a corridor of 10 m x 2 m between them; 100 people from the "
           "first to the second, 0, 10, 50 or 100 the other way; 3 seeds.",
           "everybody arrives, and the hundred take the longer the more come against them",
           counterflow}};
}

}  // namespace throng::validation
