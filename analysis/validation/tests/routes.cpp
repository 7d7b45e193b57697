// Tests of routes: assigned exits, a crowd round a corner, use of the width, choice of exits.
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/validation/recorded_setups.h"
#include "analysis/validation/setups.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/validation.h"
#include "avatars/mesh/primitives.h"

namespace throng::validation {
namespace {

// A corridor 1 m wide along x with six cabins on either side. The main exit is at the end of a
// branch between the second and third cabin of the upper side, the secondary one at the corridor's
// end.
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
  bool by_main;  ///< true: assigned to the main exit
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
      "{} of {} by their assigned exit, {} by the other one; {} by the main exit, "
      "{} "
      "by the secondary one, the last after {:.0f} s",
      right, trial.size(), wrong, main.passages().size(), secondary.passages().size(),
      trial.now_s());
  return outcome;
}

// A corridor 20 m wide: straight, or round a corner with a cut outer side.
constexpr double kCorridorWidth_m = 20;
constexpr double kCrowdDepth_m = 10;
constexpr int kRows = 20, kColumns = 25;
constexpr int kEvacuees = kRows * kColumns;

/// Adds the crowd in the last metres below `top_y`.
void crowd(Plan& plan, double top_y, const Rectangle& exit) {
  plan.people_in_rows(kRows, kColumns, {{0, top_y - kCrowdDepth_m}, {kCorridorWidth_m, top_y}},
                      {exit});
}

Plan straight(double length_m, const Conditions& conditions) {
  Plan plan = carved("straight", {{{0, -3}, {kCorridorWidth_m, length_m}}}, {conditions.model},
                     conditions.seed);
  crowd(plan, length_m, {{0, -3}, {kCorridorWidth_m, -2}});
  return plan;
}

/// Down along y, then right, with the exit at x = 30.
Plan round_a_corner(const Conditions& conditions) {
  constexpr double kTop_m = 60, kOut_m = 30, kCut_m = 10, kThick_m = 3;
  Plan plan =
      carved("wide_corner",
             {{{0, 0}, {kCorridorWidth_m, kTop_m}}, {{0, 0}, {kOut_m + 3, kCorridorWidth_m}}},
             {conditions.model}, conditions.seed);
  Obstacle cut;
  cut.size_m = {std::sqrt(2.0) * kCut_m, kThick_m, 3};
  cut.heading_rad = -0.25 * std::numbers::pi;
  const double middle_m = 0.5 * kCut_m - 0.5 * kThick_m * std::sqrt(0.5);
  cut.centre_m = {middle_m, middle_m, 1.5};
  cut.mesh = box_mesh(cut.size_m);
  plan.solid(std::move(cut));
  crowd(plan, kTop_m, {{kOut_m + 2, 0}, {kOut_m + 3, kCorridorWidth_m}});
  return plan;
}

/// Passage times of all people; empty unless all have passed.
std::vector<double> leave(const Plan& plan, Gate gate, Outcome& outcome) {
  Trial trial(plan);
  while (trial.step(600)) gate.watch(trial);
  note(outcome, trial);
  return gate.times_s();
}

Outcome wide_corner(const Conditions& conditions) {
  constexpr double kShort_m = 50, kLong_m = 81;
  Outcome outcome;
  const Gate down(Gate::Along::kY, 0, 0, kCorridorWidth_m, false);
  const std::vector<double> times[] = {
      leave(straight(kShort_m, conditions), down, outcome),
      leave(round_a_corner(conditions), Gate(Gate::Along::kX, 30, 0, kCorridorWidth_m), outcome),
      leave(straight(kLong_m, conditions), down, outcome)};
  bool all_left = true;
  double last_s[3] = {}, mean_s[3] = {};
  std::string data, plots;
  const char* const names[] = {"50 m straight on", "round the corner", "81 m straight on"};
  for (size_t i = 0; i < 3; ++i) {
    all_left = all_left && times[i].size() == kEvacuees;
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
  outcome.passed = all_left && last_s[0] <= last_s[1] && last_s[1] <= last_s[2] &&
                   mean_s[0] <= mean_s[1] && mean_s[1] <= mean_s[2];
  outcome.measured = fmt::format(
      "{}last out after {:.0f} s by 50 m straight on, {:.0f} s round the corner, {:.0f} s by 81 m "
      "straight on; on average {:.0f}, {:.0f} and {:.0f} s",
      all_left ? "" : "some people did not leave; ", last_s[0], last_s[1], last_s[2], mean_s[0],
      mean_s[1], mean_s[2]);
  outcome.figures.push_back(
      {"rimea_15", "RiMEA 15: people who have left, round a corner and straight", "",
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
       "all people leave by their assigned exit",
       assigned_exits},
      {{"rimea_15"},
       {"RiMEA 15: a large crowd round a corner"},
       "500 people in the first 10 m of a corridor 20 m wide: 50 m straight on, 81 m straight on, "
       "and "
       "round a corner (40 m to its inner edge and 10 m on) with a cut outer side.",
       "round the corner people take longer than on the short and less than on the long straight "
       "path: for the last person, and on average",
       wide_corner}};
}

namespace {

constexpr double kStrip_m = 0.5;
constexpr Oval kRing = {0, 7, 3};
constexpr int kRingPeople = 80;
/// Shares of the fullest lane differ between crowds by some hundredths.
constexpr uint64_t kRings = 3;
constexpr double kRingBegin_s = 30;
constexpr double kRingEnd_s = 210;
constexpr double kCorner_m = 4;
constexpr int kCornerPeople = 200;
constexpr double kLeg_m = 30;
constexpr int kHallPeople = 600;

void add(std::vector<double>& lanes, double from_inside_m, double seconds) {
  if (from_inside_m < 0) return;
  const auto lane = static_cast<size_t>(from_inside_m / kStrip_m);
  if (lane < lanes.size()) lanes[lane] += seconds;
}

Figure figure_of(const std::string& id, const std::string& title,
                 const std::vector<double>& lanes) {
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  std::string data;
  for (size_t i = 0; i < lanes.size(); ++i)
    data += fmt::format("{:.2f} {:.2f}\n", kStrip_m * (static_cast<double>(i) + 0.5),
                        sum > 0 ? 100 * lanes[i] / sum : 0);
  return {id, title, "",
          "$data << EOD\n" + data +
              fmt::format("EOD\nset grid ytics\nunset key\nset style fill solid 0.85\nset boxwidth "
                          "0.45\nset xrange [0:*]\nset yrange [0:*]\nset xlabel 'from the inner "
                          "wall, m'\nset ylabel "
                          "'% of the person-seconds'\nplot $data with boxes linecolor rgb '{}'\n",
                          kFigureColours[0])};
}

void go_round(const Plan& plan, std::vector<double>& lanes, Outcome& outcome) {
  Trial trial(plan);
  while (trial.step(kRingEnd_s)) {
    outcome.wall_crossings += kRing.strays(trial);
    if (trial.now_s() < kRingBegin_s) continue;
    for (size_t id = 0; id < trial.size(); ++id)
      add(lanes, kRing.aside_m(trial.position_m(id)) + 0.5 * kRing.width_m, trial.step_s());
  }
  note(outcome, trial);
}

Outcome ring(const Conditions& conditions) {
  Outcome outcome;
  std::vector<double> lanes(static_cast<size_t>(std::lround(kRing.width_m / kStrip_m)), 0);
  for (uint64_t crowd = 0; crowd < kRings; ++crowd)
    go_round(ring_plan(conditions.model, conditions.seed_of_run(crowd, kRings)), lanes, outcome);
  outcome.figures = {figure_of("ring", "Ring of 3 m: where people walk", lanes)};
  return judged(std::move(outcome), judge_fullest_lane(lanes, 0.35));
}

Outcome corner(const Conditions& conditions) {
  Outcome outcome;
  Trial trial(corner_plan(conditions.model, conditions.seed));
  std::vector<double> lanes(static_cast<size_t>(std::lround(kCorner_m / kStrip_m)), 0);
  while (trial.step(300))
    for (size_t id = 0; id < trial.size(); ++id) {
      const Eigen::Vector2d from_inside = trial.position_m(id) - Eigen::Vector2d(kLeg_m, kCorner_m);
      // Only in the square of the corner: right of the inner corner and below it.
      if (!trial.is_present(id) || from_inside.x() < 0 || from_inside.y() > 0) continue;
      add(lanes, from_inside.norm(), trial.step_s());
    }
  note(outcome, trial);
  outcome.figures = {figure_of("corner", "Corner of 4 m: where people walk", lanes)};
  return judged(std::move(outcome), judge_used_lanes(lanes, 5, 0.05));
}

Outcome two_exits(const Conditions& conditions) {
  Outcome outcome;
  Trial trial(two_exits_plan(conditions.model, conditions.seed));
  Gate near(Gate::Along::kY, -0.1, 0, 15, false);
  Gate far(Gate::Along::kY, -0.1, 15, 30, false);
  while (trial.step(1200)) {
    near.watch(trial);
    far.watch(trial);
  }
  note(outcome, trial);
  const auto count = [](const Gate& gate) { return static_cast<int>(gate.passages().size()); };
  return judged(std::move(outcome), judge_far_exit(count(near), count(far), kHallPeople));
}

}  // namespace

Plan ring_plan(SteeringKind model, uint64_t seed) {
  Plan plan = kRing.plan("ring", {model}, seed);
  kRing.populate(plan, kRingPeople, {}, false);
  return plan;
}

Plan corner_plan(SteeringKind model, uint64_t seed) {
  const double end_m = kLeg_m + kCorner_m;
  Plan plan =
      carved("corner", {{{0, 0}, {end_m, kCorner_m}}, {{kLeg_m, 0}, {end_m, kCorner_m + 20}}},
             {model}, seed);
  plan.people(kCornerPeople, {{0, 0}, {kLeg_m - 2, kCorner_m}},
              {{{kLeg_m, kCorner_m + 19}, {end_m, kCorner_m + 20}}});
  return plan;
}

Plan two_exits_plan(SteeringKind model, uint64_t seed) {
  constexpr double kDoor_m = 1;
  constexpr double kOut_m = 3;
  std::vector<Rectangle> open = {{{0, 0}, {30, 20}}, {{0, -kOut_m}, {30, -Plan::kWall_m}}};
  for (const double middle : {7.5, 22.5})
    open.push_back({{middle - 0.5 * kDoor_m, -Plan::kWall_m}, {middle + 0.5 * kDoor_m, 0}});
  Plan plan = carved("two_exits", open, {model}, seed);
  plan.people_packed(kHallPeople, {{0, 0}, {15, 20}}, {{{0, -kOut_m}, {30, 0.8 - kOut_m}}});
  return plan;
}

std::vector<Test> spreading_tests() {
  return {
      {{"ring"},
       {"A ring of 3 m: people use its width"},
       "A ring 3 m wide around a circle of 7 m, 80 adults walk round (0.5 per m2), seconds 30 to "
       "210, three times; lanes of 0.5 m.",
       "no lane holds more than 35 % of the person-seconds (source: Throng; with an even spread "
       "the "
       "fullest holds 20 %)",
       ring},
      {{"corner"},
       {"A corner of 4 m: people use its width"},
       "A corridor 4 m wide turns by 90 degrees after 30 m, 200 adults; lanes of 0.5 m by the "
       "distance from the inner corner, of people in the square of the corner.",
       "at least five lanes hold 5 % of the person-seconds each (source: Throng)",
       corner},
      {{"rimea_11"},
       {"RiMEA 11: choice of exits"},
       "A hall of 30 m x 20 m with two exits of 1 m in a long side, 15 m apart; 600 adults in the "
       "half of the hall with one of them.",
       "RiMEA 4.1.0: most take the near exit, some the other; here at least a third takes the far "
       "one, and all people leave",
       two_exits}};
}

}  // namespace throng::validation
