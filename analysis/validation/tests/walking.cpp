// Tests of people who walk alone or nearly alone: speed, starting times, corners.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "analysis/validation/trial.h"
#include "analysis/validation/validation.h"
#include "base/random.h"

namespace throng::validation {
namespace {

/// Time of one person from x = 0 to x = 40 m in a corridor of 2 m.
Outcome walk_a_corridor(const Conditions& conditions, double speed_mps,
                        const std::function<bool(double)>& passes, const char* format) {
  Plan plan("corridor", {{-2, 0}, {44, 2}}, {conditions.model}, conditions.seed);
  Group& walker = plan.people(1, {{-1.2, 0.9}, {-1, 1.1}}, {{{42, 0}, {44, 2}}});
  walker.speed_mps = fixed(speed_mps);
  Trial trial(plan);
  Gate start(Gate::Along::kX, 0, 0, 2);
  Gate finish(Gate::Along::kX, 40, 0, 2);
  while (trial.step(120)) {
    start.watch(trial);
    finish.watch(trial);
  }
  Outcome outcome;
  note(outcome, trial);
  if (finish.passages().empty()) {
    outcome.measured = "never arrived";
    return outcome;
  }
  const double time_s = finish.times_s().front() - start.times_s().front();
  outcome.passed = passes(time_s);
  outcome.measured = fmt::format(fmt::runtime(format), time_s, 40 / time_s);
  return outcome;
}

Outcome start_on_time(const Conditions& conditions) {
  // A room of 8 m x 5 m with a door of 1 m in the short wall, and 4 m of ground outside.
  Plan plan("delays", {{0, 0}, {12, 5}}, {conditions.model}, conditions.seed);
  plan.wall_along_y(0, 5, 8.1, {2.5}, 1);
  constexpr int kDelayed = 10;
  for (int i = 0; i < kDelayed; ++i) {
    const int column = i % 5, row = i / 5;
    const double x = 0.8 + 1.5 * column;
    const double y = 1.2 + 2.5 * row;
    Group& one = plan.people(1, {{x, y}, {x + 0.1, y + 0.1}}, {{{11, 0}, {12, 5}}});
    one.premovement_s = fixed(10.0 * (i + 1));
  }
  Trial trial(plan);
  std::vector<Eigen::Vector2d> from;
  for (size_t id = 0; id < trial.size(); ++id) from.push_back(trial.position_m(id));
  std::vector<double> started_s(trial.size(), -1);
  Gate door(Gate::Along::kX, 8.1, 0, 5);
  while (trial.step(200)) {
    door.watch(trial);
    for (size_t id = 0; id < trial.size(); ++id)
      if (started_s[id] < 0 && (trial.position_m(id) - from[id]).norm() > 0.05)
        started_s[id] = trial.now_s();
  }
  Outcome outcome;
  note(outcome, trial);
  double earliest = 1e9, latest = -1e9;
  std::string data;
  for (size_t id = 0; id < trial.size(); ++id) {
    const double planned_s = 10.0 * static_cast<double>(id + 1);
    earliest = std::min(earliest, started_s[id] - planned_s);
    latest = std::max(latest, started_s[id] - planned_s);
    data += fmt::format("{} {}\n", planned_s, started_s[id]);
  }
  outcome.passed = trial.size() == kDelayed && earliest >= 0 && latest <= 1 &&
                   door.passages().size() == kDelayed;
  outcome.measured =
      fmt::format("{} of 10 left the room; they start {:.2f} to {:.2f} s after their time",
                  door.passages().size(), earliest, latest);
  outcome.figures.push_back(
      {"rimea_5", "RiMEA 5: starting times", "",
       "$data << EOD\n" + data +
           fmt::format("EOD\nset grid\nset key top left\nset xlabel 'pre-movement time, s'\nset "
                       "ylabel 'start, s'\nplot x with lines linecolor rgb '#bbbbbb' title "
                       "'on time', $data with points pointtype 7 linecolor rgb '{}' title "
                       "'people'\n",
                       kFigureColours[0])});
  return outcome;
}

Outcome turn_a_corner(const Conditions& conditions) {
  // The corridor is the ground without one block.
  Plan plan("corner", {{0, 0}, {12, 12}}, {conditions.model}, conditions.seed);
  plan.wall(0, 2, 10, 12);
  plan.people(20, {{0.2, 0.2}, {6, 1.8}}, {{{10, 11.3}, {12, 12}}});
  Trial trial(plan);
  Gate exit(Gate::Along::kY, 11, 10, 12);
  std::string paths;
  std::vector<std::string> lines(trial.size());
  double nearest_m = 1e9;
  int frame = 0;
  while (trial.step(120)) {
    exit.watch(trial);
    for (size_t id = 0; id < trial.size(); ++id) {
      if (!trial.is_present(id)) continue;
      const Eigen::Vector2d& p = trial.position_m(id);
      const Eigen::Vector2d outside(std::max(0.0, p.x() - 10), std::max(0.0, 2 - p.y()));
      nearest_m = std::min(nearest_m, outside.norm());
      if (frame % 4 == 0) lines[id] += fmt::format("{:.3f} {:.3f}\n", p.x(), p.y());
    }
    ++frame;
  }
  for (const std::string& line : lines) paths += line + "\n";
  Outcome outcome;
  note(outcome, trial);
  outcome.passed = trial.wall_crossings() == 0 && exit.passages().size() == 20;
  outcome.measured = fmt::format(
      "{} of 20 round the corner in {:.1f} s, {} moves through a wall, centres at least {:.2f} m "
      "from the inner corner's walls",
      exit.passages().size(), trial.now_s(), trial.wall_crossings(), nearest_m);
  outcome.figures.push_back(
      {"rimea_6", "RiMEA 6: twenty paths round the corner", "",
       "$data << EOD\n" + paths +
           fmt::format("EOD\nset size ratio -1\nset xrange [-0.2:12.2]\nset yrange "
                       "[-0.2:12.2]\nunset key\nset xlabel 'x, m'\nset ylabel 'y, m'\nset object 1 "
                       "rectangle from 0,2 to 10,12 fillcolor rgb '#dddddd' fillstyle solid\nset "
                       "object 2 rectangle from 0,0 to 12,12 fillstyle empty\nplot $data with "
                       "lines linecolor rgb '{}'\n",
                       kFigureColours[0])});
  return outcome;
}

/// Speed range of the test for one of Throng's ages.
struct AgeRange {  // NOLINT(clang-analyzer-optin.performance.Padding): by meaning
  const char* name;
  Age age;
  double min_mps, max_mps;
  int count;
};
// Weidmann (1993), as RiMEA 4.1.0 lists it: under 30, 30 to 50, over 50, impaired.
constexpr AgeRange kAges[] = {{"under 30", Age::kYoung, 0.58, 1.61, 15},
                              {"30 to 50", Age::kMiddleAged, 1.41, 1.54, 15},
                              {"over 50", Age::kElderly, 0.68, 1.41, 14},
                              {"impaired", Age::kImpaired, 0.46, 0.76, 6}};
constexpr double kWalkway_m = 4;

/// Speeds of people who walk 4 m apart over 20 m; 0 for those who did not finish. `walkers`: only
/// ages and speeds are used.
std::vector<double> speeds_of(SteeringKind model, const std::vector<Group>& walkers, uint64_t seed,
                              Outcome& outcome) {
  const double width_m = kWalkway_m * static_cast<double>(walkers.size());
  Plan plan("lanes", {{0, 0}, {40, width_m}}, {model}, seed);
  for (size_t i = 0; i < walkers.size(); ++i) {
    const double y = kWalkway_m * (static_cast<double>(i) + 0.5);
    // One goal for all, to share one flow field.
    Group& one = plan.people(1, {{1, y - 0.1}, {1.2, y + 0.1}}, {{{36, 0}, {38, width_m}}});
    one.ages = walkers[i].ages;
    one.speed_mps = walkers[i].speed_mps;
  }
  Trial trial(plan);
  Gate start(Gate::Along::kX, 10, 0, width_m);
  Gate finish(Gate::Along::kX, 30, 0, width_m);
  while (trial.step(120)) {
    start.watch(trial);
    finish.watch(trial);
  }
  std::vector<double> begun(walkers.size(), 0), out(walkers.size(), 0);
  for (const Gate::Passage& passage : start.passages()) begun[passage.id] = passage.time_s;
  for (const Gate::Passage& passage : finish.passages())
    out[passage.id] = 20 / (passage.time_s - begun[passage.id]);
  note(outcome, trial);
  return out;
}

Outcome speeds_by_age(const Conditions& conditions) {
  std::vector<Group> walkers;
  for (const AgeRange& range : kAges) {
    Group walker;
    walker.ages = *ages_of(age_group(range.age).name);
    walkers.insert(walkers.end(), static_cast<size_t>(range.count), walker);
  }
  Outcome outcome;
  const std::vector<double> speeds = speeds_of(conditions.model, walkers, conditions.seed, outcome);
  int inside = 0;
  size_t id = 0;
  std::string data, ranges;
  for (size_t g = 0; g < std::size(kAges); ++g) {
    ranges += fmt::format("{} {} {} {} '{}'\n", g, 0.5 * (kAges[g].min_mps + kAges[g].max_mps),
                          kAges[g].min_mps, kAges[g].max_mps, kAges[g].name);
    for (int i = 0; i < kAges[g].count; ++i, ++id) {
      // 1 mm/s of tolerance for the rounding of crossing times.
      inside += speeds[id] > kAges[g].min_mps - 1e-3 && speeds[id] < kAges[g].max_mps + 1e-3;
      data += fmt::format("{:.3f} {:.4f}\n",
                          static_cast<double>(g) - 0.25 + 0.5 * i / kAges[g].count, speeds[id]);
    }
  }
  outcome.passed = inside == 50 && walkers.size() == 50;
  outcome.measured =
      fmt::format("{} of 50 walk at a speed inside the range of their group", inside);
  outcome.figures.push_back(
      {"rimea_7", "RiMEA 7: walking speeds by age", "Bars: the ranges of Weidmann (1993).",
       "$data << EOD\n" + data + "EOD\n$ranges << EOD\n" + ranges +
           fmt::format("EOD\nset grid ytics\nset xrange [-0.6:3.6]\nset yrange [0:1.8]\nset ylabel "
                       "'measured speed, m/s'\nunset key\nset boxwidth 0.7\nplot $ranges using "
                       "1:2:3:4:xtic(5) with yerrorbars linewidth 12 linecolor rgb '#dddddd' "
                       "pointtype 0, $data with points pointtype 7 linecolor rgb '{}'\n",
                       kFigureColours[0])});
  return outcome;
}

Outcome speed_distribution(const Conditions& conditions) {
  constexpr uint64_t kRuns = 5;
  Outcome outcome;
  std::vector<double> all;
  Group walker;
  walker.speed_mps = Distribution{1.2, 0.2, 0.4, 2.0};
  for (uint64_t run = 0; run < kRuns; ++run) {
    const std::vector<double> speeds = speeds_of(conditions.model, std::vector<Group>(100, walker),
                                                 conditions.seed_of_run(run, kRuns), outcome);
    all.insert(all.end(), speeds.begin(), speeds.end());
  }
  double sum = 0, squares = 0;
  for (const double speed : all) sum += speed;
  const double mean = sum / static_cast<double>(all.size());
  for (const double speed : all) squares += (speed - mean) * (speed - mean);
  const double deviation = std::sqrt(squares / static_cast<double>(all.size() - 1));
  outcome.passed = std::abs(mean - 1.2) <= 0.05 && std::abs(deviation - 0.2) <= 0.05;
  outcome.measured = fmt::format("mean {:.3f} m/s, standard deviation {:.3f} m/s over {} people",
                                 mean, deviation, all.size());
  std::vector<int> bars(20, 0);
  for (const double speed : all)
    ++bars[static_cast<size_t>(std::clamp(std::floor((speed - 0.2) / 0.1), 0.0, 19.0))];
  std::string data;
  for (size_t i = 0; i < bars.size(); ++i)
    data += fmt::format("{:.2f} {}\n", 0.25 + 0.1 * static_cast<double>(i), bars[i]);
  outcome.figures.push_back(
      {"iso_5", "ISO 20414 5: walking speeds of 500 people",
       "Line: the required normal distribution.",
       "$data << EOD\n" + data +
           fmt::format(
               "EOD\nset grid ytics\nset xlabel 'measured speed, m/s'\nset ylabel 'people'\n"
               "set style fill solid 0.85\nset boxwidth 0.09\nset samples 300\nset xrange "
               "[0.4:2]\nplot $data with boxes linecolor rgb '{}' title 'measured', 50 / "
               "(0.2 * sqrt(2 * pi)) * exp(-(x - 1.2)**2 / 0.08) with lines linewidth 2 "
               "linecolor rgb '{}' title 'N(1.2, 0.2)'\n",
               kFigureColours[0], kFigureColours[1])});
  return outcome;
}

}  // namespace

std::vector<Test> walking_tests() {
  return {
      {{"rimea_1"},
       {"RiMEA 1: keeping the set speed in a corridor"},
       "Corridor 40 m x 2 m, one person with a desired speed of 1.33 m/s.",
       "26 to 34 s for the 40 m",
       [](const Conditions& conditions) {
         return walk_a_corridor(
             conditions, 1.33, [](double time_s) { return time_s >= 26 && time_s <= 34; },
             "{:.2f} s");
       }},
      {{"imo_1", "iso_2"},
       {"IMO 1: keeping the set speed in a corridor", "ISO 20414 2: speed in a corridor"},
       "Corridor 40 m x 2 m, one person with a desired speed of 1.0 m/s.",
       "1.0 m/s within 0.05 m/s",
       [](const Conditions& conditions) {
         return walk_a_corridor(
             conditions, 1.0, [](double time_s) { return std::abs(40 / time_s - 1) <= 0.05; },
             "{:.2f} s, {:.3f} m/s");
       }},
      {{"rimea_5", "imo_5"},
       {"RiMEA 5: pre-movement time", "IMO 5: response duration"},
       "Room 8 m x 5 m with an exit of 1 m, 10 people with pre-movement times of 10, 20, ..., 100 "
       "s.",
       "all people start at the given time: not before it, and at most 1 s after it",
       start_on_time},
      {{"rimea_6", "imo_6", "iso_4"},
       {"RiMEA 6: round a corner", "IMO 6: rounding corners", "ISO 20414 4: round a corner"},
       "A corridor of 2 m turns left after 12 m; 20 people begin in its first 6 m.",
       "all people pass the corner, none passes a wall",
       turn_a_corner},
      {{"rimea_7"},
       {"RiMEA 7: desired speeds by age"},
       "50 adults (15 `young`, 15 `middle_aged`, 14 `elderly`, 6 `impaired`), each 4 m from the "
       "next, over 20 m.",
       "all speeds inside the range of the age group (Weidmann 1993)",
       speeds_by_age},
      {{"iso_5"},
       {"ISO 20414 5: assigned walking speeds"},
       "5 runs of 100 people with desired speeds N(1.2, 0.2) m/s, each 4 m from the next, over 20 "
       "m.",
       "mean and standard deviation of all within 0.05 m/s",
       speed_distribution}};
}

}  // namespace throng::validation
