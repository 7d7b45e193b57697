// Tests of doors: flow through one, a large room with four and two exits, a neck between two rooms.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/validation/empirical_tables.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/validation.h"
#include "analysis/validation/verdicts.h"

namespace throng::validation {
namespace {

/// Lines "time count" of passages.
std::string cumulative(const std::vector<double>& times_s) {
  std::string text = "0 0\n";
  for (size_t i = 0; i < times_s.size(); ++i) text += fmt::format("{:.2f} {}\n", times_s[i], i + 1);
  return text;
}

std::vector<double> leave_by_one_door(const Conditions& conditions, Outcome& outcome) {
  Plan plan("exit", {{0, 0}, {12, 5}}, {conditions.model}, conditions.seed);
  plan.wall_along_y(0, 5, 8.1, {2.5}, 1);
  plan.people_in_rows(10, 10, {{0, 0}, {8, 5}}, {{{10.5, 0}, {12, 5}}});
  Trial trial(plan);
  Gate door(Gate::Along::kX, 8.1, 2, 3);
  while (trial.step(600)) door.watch(trial);
  note(outcome, trial);
  return door.times_s();
}

constexpr double kAllowed_per_m_and_s = 1.33;

Outcome exit_flow(const Conditions& conditions) {
  Outcome outcome;
  const std::vector<double> times_s = leave_by_one_door(conditions, outcome);
  const double flow = flow_per_s(times_s), recorded_per_s = recorded_door(1).mean_per_s();
  outcome.passed = times_s.size() == 100;
  outcome.differs = outcome.passed && flow > kAllowed_per_m_and_s;
  outcome.measured = fmt::format(
      "{} of 100 left, {:.2f} people/(m s) from the first to the last; in experiments "
      "{:.2f}",
      times_s.size(), flow, recorded_per_s);
  outcome.figures.push_back(
      {"imo_4", "IMO 4: people through the door of 1 m", "",
       "$crowd << EOD\n" + cumulative(times_s) +
           fmt::format(
               "EOD\nset grid\nset key bottom right\nset xrange [0:*]\nset yrange [0:110]\nset "
               "xlabel 'time, s'\nset ylabel 'people through the door'\nplot {0} * (x - {1:.2f}) "
               "with lines dashtype 2 linecolor rgb '#999999' title '{0} people/(m s), allowed', "
               "{2:.2f} * (x - {1:.2f}) with lines dashtype 3 linecolor rgb '#999999' title "
               "'{2:.2f}, "
               "recorded', $crowd with steps linewidth 2 linecolor rgb '{3}' title 'simulated'\n",
               kAllowed_per_m_and_s, times_s.empty() ? 0.0 : times_s.front(), recorded_per_s,
               kFigureColours[0])});
  return outcome;
}

std::vector<double> leave_a_hall(const Conditions& conditions, int doors, Outcome& outcome) {
  // Doors in the long sides, at one and three quarters of their length.
  Plan plan("hall", {{0, -2}, {30, 22}}, {conditions.model}, conditions.seed);
  const std::vector<double> middles = {7.5, 22.5};
  plan.wall_along_x(0, 30, -0.1, middles, 1);
  plan.wall_along_x(0, 30, 20.1, doors == 4 ? middles : std::vector<double>(), 1);
  std::vector<Rectangle> exits = {{{0, -2}, {30, -1.2}}};
  if (doors == 4) exits.push_back({{0, 21.2}, {30, 22}});
  plan.people(1000, {{0, 0}, {30, 20}}, exits);
  Trial trial(plan);
  Gate south(Gate::Along::kY, -0.1, 0, 30, false);
  Gate north(Gate::Along::kY, 20.1, 0, 30);
  while (trial.step(1500)) {
    south.watch(trial);
    north.watch(trial);
  }
  note(outcome, trial);
  std::vector<double> times = south.times_s();
  const std::vector<double> more = north.times_s();
  times.insert(times.end(), more.begin(), more.end());
  std::sort(times.begin(), times.end());
  return times;
}

Outcome large_hall(const Conditions& conditions) {
  Outcome outcome;
  const std::vector<double> four = leave_a_hall(conditions, 4, outcome);
  const std::vector<double> two = leave_a_hall(conditions, 2, outcome);
  const bool all_left = four.size() == 1000 && two.size() == 1000;
  const double ratio = all_left ? two.back() / four.back() : 0;
  outcome.passed = all_left && ratio >= 1.6 && ratio <= 2.4;
  outcome.measured = fmt::format(
      "{} people in {:.0f} s by four exits, {} in {:.0f} s by two: ratio {:.2f}", four.size(),
      four.empty() ? 0 : four.back(), two.size(), two.empty() ? 0 : two.back(), ratio);
  outcome.figures.push_back(
      {"rimea_9", "RiMEA 9: people who have left the hall", "",
       "$four << EOD\n" + cumulative(four) + "EOD\n$two << EOD\n" + cumulative(two) +
           fmt::format(
               "EOD\nset grid\nset key bottom right\nset xrange [0:*]\nset yrange "
               "[0:1100]\nset xlabel 'time, s'\nset ylabel 'people outside'\nplot $four with "
               "steps linewidth 2 linecolor rgb '{}' title 'four exits of 1 m', $two with "
               "steps linewidth 2 linecolor rgb '{}' title 'two'\n",
               kFigureColours[0], kFigureColours[1])});
  return outcome;
}

constexpr double kWindow_s = 10;
constexpr int kPeople = 150;
constexpr double kExit_m = 1;  ///< exit of the second room

/// Two rooms of 10 m x 10 m and a neck of 5 m between them.
struct NeckResult {
  std::vector<double> neck_s;  ///< times of entering the neck
  std::vector<double> exit_s;  ///< times of leaving the second room
  Crowding before_neck;
  Crowding before_exit;
  std::string densities;  ///< lines of time, density before the neck, density before the exit
};

NeckResult measure_neck_flow(SteeringKind model, double width_m, uint64_t seed, Outcome& outcome) {
  Plan plan("neck", {{0, 0}, {27, 10}}, {model}, seed);
  plan.wall(10, 0, 15, 5 - 0.5 * width_m);
  plan.wall(10, 5 + 0.5 * width_m, 15, 10);
  plan.wall_along_y(0, 10, 25.1, {5}, kExit_m);
  plan.people(kPeople, {{0, 0}, {9, 10}}, {{{26.3, 0}, {27, 10}}});
  Trial trial(plan);
  Gate neck(Gate::Along::kX, 10, 0, 10);
  Gate exit(Gate::Along::kX, 25.1, 0, 10);
  NeckResult result;
  double before_neck = 0, before_exit = 0;
  int samples = 0;
  const auto take = [&](double per_m2, Crowding& crowding) {
    crowding.max_per_m2 = std::max(crowding.max_per_m2, per_m2);
    crowding.queued += per_m2 > kQueue_per_m2 ? kWindow_s : 0;
    crowding.jammed += per_m2 > kJam_per_m2 ? kWindow_s : 0;
  };
  while (trial.step(600)) {
    neck.watch(trial);
    exit.watch(trial);
    for (size_t id = 0; id < trial.size(); ++id) {
      const Eigen::Vector2d& p = trial.position_m(id);
      if (!trial.is_present(id) || std::abs(p.y() - 5) > 1) continue;
      before_neck += p.x() >= 8 && p.x() < 10;
      before_exit += p.x() >= 23 && p.x() < 25;
    }
    if (++samples * trial.step_s() < kWindow_s) continue;
    before_neck /= 4 * samples;
    before_exit /= 4 * samples;
    take(before_neck, result.before_neck);
    take(before_exit, result.before_exit);
    result.densities += fmt::format("{:.1f} {:.3f} {:.3f}\n", trial.now_s() - 0.5 * kWindow_s,
                                    before_neck, before_exit);
    before_neck = before_exit = 0;
    samples = 0;
  }
  note(outcome, trial);
  for (Crowding* crowding : {&result.before_neck, &result.before_exit}) {
    crowding->queued /= trial.now_s();
    crowding->jammed /= trial.now_s();
  }
  result.neck_s = neck.times_s();
  result.exit_s = exit.times_s();
  return result;
}

void add(const Crowding& more, double share, Crowding& mean) {
  mean.max_per_m2 += share * more.max_per_m2;
  mean.queued += share * more.queued;
  mean.jammed += share * more.jammed;
}

Outcome neck_flow(const Conditions& conditions) {
  Outcome outcome;
  std::vector<NeckPassage> necks;
  std::string densities;  // for the neck as wide as the exit
  std::string script, plots;
  constexpr uint64_t kSeeds = 3;
  for (const double width_m : {0.8, kExit_m, 1.2}) {
    NeckPassage neck{width_m, 0, true, {}, {}};  // means over the seeds
    for (uint64_t run = 0; run < kSeeds; ++run) {
      const NeckResult each = measure_neck_flow(conditions.model, width_m,
                                                conditions.seed_of_run(run, kSeeds), outcome);
      neck.flow_per_s += flow_per_s(each.neck_s) / kSeeds;
      neck.all_through = neck.all_through && each.exit_s.size() == kPeople;
      add(each.before_neck, 1.0 / kSeeds, neck.before_neck);
      add(each.before_exit, 1.0 / kSeeds, neck.before_exit);
      if (run > 0) continue;
      if (width_m == kExit_m) densities = each.densities;
      script += fmt::format("$w{:.0f} << EOD\n{}EOD\n", 10 * width_m, cumulative(each.neck_s));
    }
    plots += fmt::format("{}$w{:.0f} with steps linewidth 2 linecolor rgb '{}' title '{} m'",
                         plots.empty() ? "plot " : ", ", 10 * width_m, kFigureColours[necks.size()],
                         width_m);
    necks.push_back(neck);
  }
  // A neck of 1.2 m may crowd the exit, because the exit is narrower.
  outcome = judged(std::move(outcome), judge_necks(necks, kExit_m));
  outcome.figures.push_back(
      {"rimea_12_flow", "RiMEA 12: people into the neck, by its width", "",
       script +
           "set grid\nset key bottom right\nset xrange [0:*]\nset yrange [0:160]\nset xlabel "
           "'time, s'\nset ylabel 'people'\n" +
           plots + "\n"});
  outcome.figures.push_back(
      {"rimea_12_density", "RiMEA 12: density before neck and exit, neck of 1 m", "",
       "$data << EOD\n" + densities +
           fmt::format("EOD\nset grid\nset yrange [0:*]\nset xlabel 'time, s'\nset ylabel 'people "
                       "per m^2, means over 10 s'\nplot $data using 1:2 with linespoints "
                       "linewidth 2 "
                       "pointtype 7 pointsize 0.4 linecolor rgb '{}' title '2 m x 2 m before the "
                       "neck', $data using 1:3 with linespoints linewidth 2 pointtype 7 pointsize "
                       "0.4 linecolor rgb '{}' title 'before the exit of the second room'\n",
                       kFigureColours[1], kFigureColours[0])});
  return outcome;
}

}  // namespace

std::vector<Test> door_tests() {
  return {
      {{"imo_4", "iso_11"},
       {"IMO 4: exit flow rate", "ISO 20414 11: maximum flow rate"},
       "100 people in a room of 8 m x 5 m with an exit of 1 m in the middle of a short side.",
       "all people leave; at most 1.33 people/(m s) on average are allowed, which every "
       "experiment exceeds: "
       "a higher flow differs, but does not fail",
       exit_flow},
      {{"rimea_9", "imo_9"},
       {"RiMEA 9: a crowd leaves a large room", "IMO 9: crowd dissipation from a large room"},
       "1000 people in 30 m x 20 m, four exits of 1 m in the long sides; then only the two of one "
       "side.",
       "all people leave; two exits take 1.6 to 2.4 times as long as four",
       large_hall},
      {{"rimea_12"},
       {"RiMEA 12: effect of bottlenecks"},
       "150 people in the first of two rooms of 10 m x 10 m, a neck of 5 m between them 0.8, 1.0 "
       "and 1.2 m wide, an exit of 1 m out of the second.",
       fmt::format(
           "the flow grows with the width; with 1 m there is a jam before the neck (more than {:g} "
           "per m2 over {:g} s for more than {:g} % of the time: IMO MSC.1/Circ.1533, annex 3, 3.1 "
           "and 3.2), and before the exit of the second room, which is as wide, there is no "
           "congestion: a jam there fails, a queue (more than {:g} per m2 over {:g} s, where "
           "Weidmann's flow is greatest) differs. RiMEA gives no density, and excludes no model by "
           "this test (means of three seeds)",
           kJam_per_m2, kWindow_s, 100 * kJamLasts, kQueue_per_m2, kWindow_s),
       neck_flow}};
}

}  // namespace throng::validation
