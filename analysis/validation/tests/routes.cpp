// Tests of the way that people take: exits that are assigned, and a large crowd round a corner.
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/validation/set_ups.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/validation.h"
#include "avatars/mesh/primitives.h"

namespace throng::validation {
namespace {

// A corridor 1 m wide along x with six cabins on either side. The main exit lies at the end of a
// way between the second and the third cabin of the upper side, the secondary one at the end of
// the corridor.
constexpr double kCorridor_y = 5;
constexpr double kCabin_m = 5;
constexpr double kCorridor_m = 18;
constexpr double kMainFrom_x = 6, kMainTo_x = 7.2;
constexpr double kCabinDoor_m = 0.9;
constexpr double kWall_m = Plan::kWall_m;

struct Cabin {
  double from_x, to_x;
  int people;
  bool is_above;
  bool by_main;  ///< assigned to the main exit
};
constexpr Cabin kCabins[] = {
    {0, 3, 2, true, true},   {3, 6, 2, true, true},     {7.2, 9, 1, true, true},
    {9, 12, 2, true, true},  {12, 15, 2, true, false},  {15, 18, 2, true, false},
    {0, 3, 2, false, true},  {3, 6, 2, false, true},    {6, 9, 2, false, true},
    {9, 12, 2, false, true}, {12, 15, 2, false, false}, {15, 18, 2, false, false},
};

Rectangle inside(const Cabin& cabin) {
  const double low_y = cabin.is_above ? kCorridor_y + 1 + kWall_m : 0;
  return {{cabin.from_x + 0.5 * kWall_m, low_y},
          {cabin.to_x - 0.5 * kWall_m, low_y + kCabin_m - kWall_m}};
}

Rectangle door_of(const Cabin& cabin) {
  const double low_y = cabin.is_above ? kCorridor_y + 1 : kCorridor_y - kWall_m;
  const double middle_x = 0.5 * (cabin.from_x + cabin.to_x);
  return {{middle_x - 0.5 * kCabinDoor_m, low_y}, {middle_x + 0.5 * kCabinDoor_m, low_y + kWall_m}};
}

Outcome assigned_exits(const Conditions& conditions) {
  const double main_y = kCorridor_y + 1 + kCabin_m;
  std::vector<Rectangle> open = {
      {{0, kCorridor_y}, {kCorridor_m + 2, kCorridor_y + 1}},
      {{kMainFrom_x, kCorridor_y + 1}, {kMainTo_x, main_y + 2}},
  };
  for (const Cabin& cabin : kCabins) {
    open.push_back(inside(cabin));
    open.push_back(door_of(cabin));
  }
  Plan plan = carved("cabins", open, {conditions.model}, conditions.seed);
  for (const Cabin& cabin : kCabins)
    plan.people(cabin.people, inside(cabin),
                {cabin.by_main ? Rectangle{{kMainFrom_x, main_y + 1}, {kMainTo_x, main_y + 2}}
                               : Rectangle{{kCorridor_m + 1, kCorridor_y},
                                           {kCorridor_m + 2, kCorridor_y + 1}}});
  Trial trial(plan);
  Gate main(Gate::Along::kY, main_y, kMainFrom_x, kMainTo_x);
  Gate secondary(Gate::Along::kX, kCorridor_m, kCorridor_y, kCorridor_y + 1);
  while (trial.step(120)) {
    main.watch(trial);
    secondary.watch(trial);
  }
  Outcome outcome;
  note(outcome, trial);
  int right = 0, wrong = 0;
  for (const auto& [gate, is_main] : {std::pair(&main, true), std::pair(&secondary, false)})
    for (const Gate::Passage& passage : gate->passages())
      ++(kCabins[trial.group(passage.id)].by_main == is_main ? right : wrong);
  outcome.passed = right == static_cast<int>(trial.size()) && wrong == 0 && trial.size() == 23;
  outcome.measured = fmt::format(
      "{} of {} by the exit that they are assigned to, {} by the other one; {} by the main exit, "
      "{} "
      "by the secondary one, the last after {:.0f} s",
      right, trial.size(), wrong, main.passages().size(), secondary.passages().size(),
      trial.now_s());
  return outcome;
}

// A way 20 m wide: straight on, or round a corner whose outer side is cut off.
constexpr double kWidth_m = 20;
constexpr double kStart_m = 10;
constexpr int kRows = 20, kColumns = 25;
constexpr int kEvacuees = kRows * kColumns;

/// In the last metres below `top_y`.
void crowd(Plan& plan, double top_y, const Rectangle& exit) {
  plan.people_in_rows(kRows, kColumns, {{0, top_y - kStart_m}, {kWidth_m, top_y}}, {exit});
}

Plan straight(double length_m, const Conditions& conditions) {
  Plan plan =
      carved("straight", {{{0, -3}, {kWidth_m, length_m}}}, {conditions.model}, conditions.seed);
  crowd(plan, length_m, {{0, -3}, {kWidth_m, -2}});
  return plan;
}

/// Down along y, then to the right and out at x = 30.
Plan round_a_corner(const Conditions& conditions) {
  constexpr double kTop_m = 60, kOut_m = 30, kCut_m = 10, kThick_m = 3;
  Plan plan =
      carved("wide_corner", {{{0, 0}, {kWidth_m, kTop_m}}, {{0, 0}, {kOut_m + 3, kWidth_m}}},
             {conditions.model}, conditions.seed);
  Obstacle cut;
  cut.size_m = {std::sqrt(2.0) * kCut_m, kThick_m, 3};
  cut.heading_rad = -0.25 * std::numbers::pi;
  const double middle_m = 0.5 * kCut_m - 0.5 * kThick_m * std::sqrt(0.5);
  cut.centre_m = {middle_m, middle_m, 1.5};
  cut.mesh = box_mesh(cut.size_m);
  plan.solid(std::move(cut));
  crowd(plan, kTop_m, {{kOut_m + 2, 0}, {kOut_m + 3, kWidth_m}});
  return plan;
}

/// When everybody has passed the line; nothing if somebody has not.
std::vector<double> leave(const Plan& plan, Gate gate, Outcome& outcome) {
  Trial trial(plan);
  while (trial.step(600)) gate.watch(trial);
  note(outcome, trial);
  return gate.times_s();
}

Outcome wide_corner(const Conditions& conditions) {
  constexpr double kShort_m = 50, kLong_m = 81;
  Outcome outcome;
  const Gate down(Gate::Along::kY, 0, 0, kWidth_m, false);
  const std::vector<double> times[] = {
      leave(straight(kShort_m, conditions), down, outcome),
      leave(round_a_corner(conditions), Gate(Gate::Along::kX, 30, 0, kWidth_m), outcome),
      leave(straight(kLong_m, conditions), down, outcome)};
  bool everybody = true;
  double last_s[3] = {}, mean_s[3] = {};
  std::string data, plots;
  const char* const names[] = {"50 m straight on", "round the corner", "81 m straight on"};
  for (size_t i = 0; i < 3; ++i) {
    everybody = everybody && times[i].size() == kEvacuees;
    data += fmt::format("$way{} << EOD\n0 0\n", i);
    for (size_t n = 0; n < times[i].size(); ++n) {
      mean_s[i] += times[i][n] / static_cast<double>(times[i].size());
      data += fmt::format("{:.2f} {}\n", times[i][n], n + 1);
    }
    data += "EOD\n";
    if (!times[i].empty()) last_s[i] = times[i].back();
    plots += fmt::format("{}$way{} with steps linewidth 2 linecolor rgb '{}' title '{}'",
                         i == 0 ? "plot " : ", ", i, kFigureColours[i], names[i]);
  }
  outcome.passed = everybody && last_s[0] <= last_s[1] && last_s[1] <= last_s[2] &&
                   mean_s[0] <= mean_s[1] && mean_s[1] <= mean_s[2];
  outcome.measured = fmt::format(
      "{}last out after {:.0f} s by 50 m straight on, {:.0f} s round the corner, {:.0f} s by 81 m "
      "straight on; on average {:.0f}, {:.0f} and {:.0f} s",
      everybody ? "" : "not everybody left; ", last_s[0], last_s[1], last_s[2], mean_s[0],
      mean_s[1], mean_s[2]);
  outcome.figures.push_back(
      {"rimea_15", "RiMEA 15: people who have left, round a corner and straight on", "",
       data +
           "set grid\nset key bottom right\nset xrange [0:*]\nset yrange [0:550]\nset xlabel "
           "'time, s'\nset ylabel 'people'\n" +
           plots + "\n"});
  return outcome;
}

}  // namespace

std::vector<Test> route_tests() {
  return {
      {{"rimea_10", "imo_10"},
       {"RiMEA 10: exits are assigned", "IMO 10: exit route allocation"},
       "A corridor of 18 m x 1 m with six cabins on either side, 23 people; fifteen in eight "
       "cabins "
       "are assigned to the main exit between two cabins, eight in the last four to the secondary "
       "one at the end of the corridor.",
       "everybody leaves by the exit assigned",
       assigned_exits},
      {{"rimea_15"},
       {"RiMEA 15: a large crowd round a corner"},
       "500 people in the first 10 m of a way 20 m wide: 50 m straight on, 81 m straight on, and "
       "round a corner (40 m to its inner edge and 10 m on) whose outer side is cut off.",
       "round the corner people take longer than by the short way and less long than by the long "
       "one: the last of them, and on average",
       wide_corner}};
}

}  // namespace throng::validation
