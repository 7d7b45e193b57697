// How people spread: over the width of a ring and of a corner, over two exits.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "analysis/validation/recorded_situations.h"

namespace throng::validation {
namespace {

constexpr double kStrip_m = 0.5;
constexpr Oval kRing = {0, 7, 3};
constexpr int kRingPeople = 80;
/// One ring's fullest lane holds some hundredths more or less than another's.
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
      // In the square of the corner: to the right of the inner corner, and below it.
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
       "A ring 3 m wide around a circle of 7 m, 80 adults go round (0.5 per m2), seconds 30 to "
       "210, three times; lanes of 0.5 m.",
       "no lane holds more than 35 % of the person-seconds (source: ours; spread evenly, the "
       "fullest holds 20 %)",
       ring},
      {{"corner"},
       {"A corner of 4 m: people use its width"},
       "A corridor 4 m wide turns by 90 degrees after 30 m, 200 adults; lanes of 0.5 m by the "
       "distance from the inner corner, of people in the square of the corner.",
       "at least five lanes hold 5 % of the person-seconds each (source: ours)",
       corner},
      {{"rimea_11"},
       {"RiMEA 11: choice of exits"},
       "A hall of 30 m x 20 m with two exits of 1 m in a long side, 15 m apart; 600 adults in the "
       "half of the hall with one of them.",
       "RiMEA 4.1.0: most take the near exit, some the other; here at least a third takes the far "
       "one, and everybody leaves",
       two_exits}};
}

}  // namespace throng::validation
