// Tests of people who pass each other: overtaking, two-way flow in one corridor.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/validation/recorded_setups.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/validation.h"
#include "base/random.h"

namespace throng::validation {
namespace {

constexpr double kFast_mps = 1.5;
constexpr double kSlow_mps = 0.6;
constexpr double kLane_m = 3;
constexpr double kPitch_m = 3.5;
constexpr double kStart_m = 2;
constexpr double kFinish_m = 32;
constexpr double kLaneEnd_m = 36;
constexpr int kLanes = 20;
constexpr int kStarts = 200;

constexpr Oval kTwoWay = {15, 3, 3};
constexpr double kTwoWay_per_m2 = 2;
constexpr int kTwoWayMinutes = 10;
/// Flows differ between crowds by some hundredths.
constexpr uint64_t kTwoWayCrowds = 3;

Outcome overtaking(const Conditions& conditions) {
  Outcome outcome;
  std::vector<Overtaking> starts;
  constexpr uint64_t kRuns = kStarts / kLanes;
  for (uint64_t run = 0; run < kRuns; ++run) {
    const std::vector<Overtaking> more =
        measure_overtaking(kLanes, conditions.model, conditions.seed_of_run(run, kRuns), outcome);
    starts.insert(starts.end(), more.begin(), more.end());
  }
  return judged(std::move(outcome), judge_overtaking(starts));
}

Outcome two_way(const Conditions& conditions) {
  Outcome outcome;
  std::vector<std::vector<double>> flows;
  for (uint64_t crowd = 0; crowd < kTwoWayCrowds; ++crowd)
    flows.push_back(measure_counterflow(kTwoWayMinutes, conditions.model,
                                        conditions.seed_of_run(crowd, kTwoWayCrowds), outcome));
  return judged(std::move(outcome), judge_counterflow(flows));
}

}  // namespace

Plan overtaking_plan(int lanes, SteeringKind model, uint64_t seed) {
  std::vector<Rectangle> open, goals;
  for (int lane = 0; lane < lanes; ++lane) {
    const double y = kPitch_m * lane;
    open.push_back({{0, y}, {kLaneEnd_m, y + kLane_m}});
    goals.push_back({{kLaneEnd_m - 2, y}, {kLaneEnd_m, y + kLane_m}});
  }
  Plan plan = carved("overtaking", open, {model}, seed);
  const Eigen::Vector2d slack = Eigen::Vector2d::Constant(0.01);
  for (int lane = 0; lane < lanes; ++lane)
    for (const bool fast : {true, false}) {
      const RandomKey key{seed, static_cast<uint64_t>(2 * lane + fast), 0, Purpose::kSpawnPosition};
      const Eigen::Vector2d at(fast ? 0.7 : 5.0, kPitch_m * lane + random_uniform(key, 0.4, 2.6));
      // One goal for all, to share one flow field.
      plan.people(1, {at - slack, at + slack}, goals).speed_mps =
          fixed(fast ? kFast_mps : kSlow_mps);
    }
  return plan;
}

std::vector<Overtaking> measure_overtaking(int lanes, SteeringKind model, uint64_t seed,
                                           Outcome& outcome) {
  Trial trial(overtaking_plan(lanes, model, seed));
  Gate start(Gate::Along::kX, kStart_m, 0, kPitch_m * lanes);
  Gate finish(Gate::Along::kX, kFinish_m, 0, kPitch_m * lanes);
  while (trial.step(90)) {
    start.watch(trial);
    finish.watch(trial);
  }
  note(outcome, trial);
  const auto time_of = [](const Gate& gate, size_t id) {
    for (const Gate::Passage& passage : gate.passages())
      if (passage.id == id) return passage.time_s;
    return 1e9;  // never passed
  };
  std::vector<Overtaking> out;
  for (size_t fast = 0; fast + 1 < trial.size(); fast += 2) {
    const double until_s = time_of(finish, fast);
    const double alone_s = (kFinish_m - kStart_m) / kFast_mps;
    const double taken_s = std::min(until_s, 90.0) - time_of(start, fast);
    out.push_back({until_s < time_of(finish, fast + 1), taken_s / alone_s - 1});
  }
  return out;
}

Plan two_way_plan(SteeringKind model, uint64_t seed) {
  Plan plan = kTwoWay.plan("two_way", {model}, seed);
  const double area_m2 = kTwoWay.length_m() * kTwoWay.width_m;
  kTwoWay.populate(plan, 2 * static_cast<int>(std::lround(0.5 * kTwoWay_per_m2 * area_m2)), {},
                   true);
  return plan;
}

std::vector<double> measure_counterflow(int minutes, SteeringKind model, uint64_t seed,
                                        Outcome& outcome) {
  Trial trial(two_way_plan(model, seed));
  std::vector<double> flows(static_cast<size_t>(minutes), 0);
  while (trial.step(60.0 * minutes)) {
    const size_t minute = std::min(flows.size() - 1, static_cast<size_t>(trial.now_s() / 60));
    for (size_t id = 0; id < trial.size(); ++id) {
      const Eigen::Vector2d& before = trial.previous_m(id);
      const Eigen::Vector2d& now = trial.position_m(id);
      if ((before.x() < 0) == (now.x() < 0)) continue;
      // Half of the people walk counter-clockwise, see populate(): leftwards in the upper straight.
      const bool counter_clockwise = (now.y() > 0) == (now.x() < 0);
      flows[minute] += counter_clockwise == (id % 2 == 0) ? 1 : -1;
    }
    outcome.wall_crossings += kTwoWay.strays(trial);
  }
  note(outcome, trial);
  for (double& flow : flows) flow /= 60 * 2 * kTwoWay.width_m;  // two lines are counted
  return flows;
}

std::vector<Test> passing_tests() {
  return {
      {{"overtaking"},
       {"A fast person overtakes"},
       "A corridor 3 m wide, a person of 1.5 m/s 4.3 m behind a person of 0.6 m/s, both "
       "at random lateral positions; from 2 to 32 m; 200 starts.",
       "95 % overtake within this distance and lose at most 10 % of their time without the other "
       "(source: Throng; people pass in corridors wider than two bodies)",
       overtaking},
      {{"two_way"},
       {"Two-way flow in one corridor for ten minutes"},
       "A corridor 3 m wide closes in an oval with straights of 15 m, centre line of 58 m; "
       "2 adults per m2, every second in the other direction; net passages of two lines; three "
       "crowds.",
       "at least 1.0 people/(m s) in both directions on average, a tenth of it in every minute of "
       "each crowd; source: "
       "`bot` of the Pedestrian Dynamics Data Archive (0.63 m/s at 2 per m2, 1.26 people/(m s))",
       two_way}};
}

namespace {

constexpr int kAgainst[] = {0, 10, 50, 100};
constexpr double kPassedWithin_s = 600;

struct Crossing {
  double last_s = 0;  ///< time at which the last of the hundred entered the other room
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
  bool all_arrive = true, grows = true;
  double before_s = 0;
  std::string list, data;
  for (const int against : kAgainst) {
    double sum_s = 0;
    std::string runs;
    for (uint64_t run = 0; run < kSeeds; ++run) {
      const uint64_t seed = conditions.seed_of_run(run, kSeeds);
      const Crossing crossing = cross(conditions.model, against, seed, outcome);
      all_arrive = all_arrive && crossing.arrived == 100 &&
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
  outcome.passed = all_arrive && grows;
  outcome.measured =
      fmt::format("{} (means of {} seeds); {}", list, kSeeds,
                  all_arrive ? "all people arrive" : "some people did not arrive within 600 s");
  outcome.figures.push_back(
      {"imo_8", "IMO 8: time of a hundred people against others", "",
       "$data << EOD\n" + data +
           fmt::format(
               "EOD\nset grid\nset key top left\nset xrange [-5:105]\nset yrange "
               "[0:*]\nset xlabel 'people in the other direction'\nset ylabel 'last of the "
               "hundred in the other room, s'\nplot for [i=3:5] $data using 1:i with points "
               "pointtype 6 linecolor rgb '#999999' title (i == 3 ? 'single seeds' : ''), "
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
           "all people arrive, and the hundred take longer against more people",
           counterflow}};
}

}  // namespace throng::validation
