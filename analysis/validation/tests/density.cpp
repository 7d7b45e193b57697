// RiMEA 4: the fundamental diagram, speed against density.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/validation/empirical_tables.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/validation.h"
#include "analysis/validation/verdicts.h"
#include "crowd/spawn.h"

namespace throng::validation {
namespace {

// For 60 s the middle of a long corridor equals a periodic one: people who leave it are replaced.
// Only the fastest people cover the 104 m behind the probes in that time. The gap that grows
// backwards from the front, at 0.7 m/s at most, does not reach back 44 m.
constexpr double kLength_m = 170;
constexpr double kFirst_m = 104;
constexpr double kLast_m = 126;
constexpr double kBegin_s = 10;
constexpr double kEnd_s = 60;

/// Number of rows that maximises the distance between neighbours.
int best_rows(double per_metre) {
  const double width_m = 2 - 2 * disc_radius_m(1.70);
  int best = 1;
  double widest_m = 0;
  for (int rows = 1; rows <= 6; ++rows) {
    const double dx = rows / per_metre;
    const double dy = rows > 1 ? width_m / (rows - 1) : 1e9;
    const double nearest_m = std::min({dx, dy * 2, std::hypot(dy, 0.5 * dx)});
    if (nearest_m > widest_m) {
      widest_m = nearest_m;
      best = rows;
    }
  }
  return best;
}

UnidirectionalSpeed measure(double target_per_m2, const Conditions& conditions, Outcome& outcome) {
  Plan plan("corridor", {{0, 0}, {kLength_m + 30, 2}}, {conditions.model}, conditions.seed);
  const int rows = best_rows(2 * target_per_m2);
  const auto columns = static_cast<int>(std::lround(target_per_m2 * 2 * kLength_m / rows));
  plan.people_in_rows(rows, columns, {{0, 0}, {kLength_m, 2}},
                      {{{kLength_m + 25, 0}, {kLength_m + 30, 2}}});
  Trial trial(plan);
  double count = 0, speed_sum = 0;
  int samples = 0;
  while (trial.step(kEnd_s)) {
    if (trial.now_s() < kBegin_s) continue;
    ++samples;
    for (size_t id = 0; id < trial.size(); ++id) {
      const double x = trial.position_m(id).x();
      if (!trial.is_present(id) || x < kFirst_m || x >= kLast_m) continue;
      count += 1;
      speed_sum += trial.velocity_mps(id).x();
    }
  }
  note(outcome, trial);
  UnidirectionalSpeed point;
  point.target_per_m2 = target_per_m2;
  point.density_per_m2 = count / samples / ((kLast_m - kFirst_m) * 2);
  point.speed_mps = count > 0 ? speed_sum / count : 0;
  return point;
}

std::string rows_of(const std::vector<UnidirectionalSpeed>& points) {
  std::string text;
  for (const UnidirectionalSpeed& point : points)
    text += fmt::format("{:.4f} {:.4f} {:.4f}\n", point.density_per_m2, point.speed_mps,
                        point.density_per_m2 * point.speed_mps);
  return text;
}

std::string curve() {
  std::string text;
  for (int tenths = 1; tenths <= 54; ++tenths) {
    const double density = tenths / 10.0;
    text += fmt::format("{:.2f} {:.4f} {:.4f}\n", density, weidmann_mps(density),
                        density * weidmann_mps(density));
  }
  return text;
}

std::string recorded_rows() {
  std::string text;
  for (const auto& [at_per_m2, low_mps, high_mps] : recorded_one_way())
    text += fmt::format("{:.3f} {:.4f} {:.4f} {:.4f} {:.4f}\n", at_per_m2, low_mps, high_mps,
                        at_per_m2 * low_mps, at_per_m2 * high_mps);
  return text;
}

std::vector<Figure> diagrams(const std::vector<UnidirectionalSpeed>& points) {
  const std::string data = "$weidmann << EOD\n" + curve() + "EOD\n$recorded << EOD\n" +
                           recorded_rows() + "EOD\n$crowd << EOD\n" + rows_of(points) +
                           "EOD\nset grid\nset xrange [0:5.5]\nset yrange [0:*]\nset key top "
                           "right\nset xlabel 'people per m^2'\n";
  const auto plot = [&](int column, int low) {
    return fmt::format(
        "plot $recorded using 1:{1}:{2} with filledcurves linecolor rgb '#dddddd' title "
        "'recorded, one way', $weidmann using 1:{0} with lines linewidth 2 linecolor rgb '#999999' "
        "title 'Weidmann 1993', $crowd using 1:{0} with points pointtype 7 pointsize 0.8 linecolor "
        "rgb '{3}' title 'simulated'\n",
        column, low, low + 1, kFigureColours[0]);
  };
  return {{"rimea_4_speed", "RiMEA 4: speed against density", "",
           data + "set ylabel 'mean speed, m/s'\n" + plot(2, 2)},
          {"rimea_4_flow", "RiMEA 4: flow against density", "",
           data + "set ylabel 'flow, people/(m s)'\n" + plot(3, 4)}};
}

Outcome fundamental_diagram(const Conditions& conditions) {
  Outcome outcome;
  std::vector<UnidirectionalSpeed> points;
  for (const double density : {0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0})
    points.push_back(measure(density, conditions, outcome));
  Judgement judgement = judge_unidirectional(points);
  judgement.passed = judgement.passed && outcome.unplaced == 0;
  outcome = judged(std::move(outcome), std::move(judgement));
  outcome.figures = diagrams(points);
  return outcome;
}

}  // namespace

std::vector<Test> density_tests() {
  return {
      {{"rimea_4"},
       {"RiMEA 4: fundamental diagram"},
       "22 m in the middle of a corridor 2 m wide and 200 m long, which for 60 s equals a "
       "periodic one; 0.5 to 5 people per m2 (6 discs of 0.22 m do not fit), without the first 10 "
       "s; density and speed as means over probes of 2 m x 2 m.",
       "from 0.5 to 3 per m2 between the slowest and the fastest tenth of those recorded at that "
       "density in corridors and round a corner, one way (`ug`, `uo`, `eo` of the Pedestrian "
       "Dynamics Data Archive); speeds within 10 % of a bound are named",
       fundamental_diagram}};
}

}  // namespace throng::validation
