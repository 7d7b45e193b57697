#include "analysis/validation/recorded_setups.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "analysis/measures/voronoi.h"

namespace throng::validation {

CellOf voronoi_cells(const Scene& scene) {
  return [cells = std::make_shared<VoronoiCells>(scene), others = std::vector<Eigen::Vector2d>()](
             const Moment& moment, size_t person) mutable {
    constexpr double kReach_m = 2 * VoronoiCells::kCap_m;
    others.clear();
    for (size_t i = 0; i < moment.present.size(); ++i) {
      if (i == person || moment.present[i] == 0) continue;
      if ((moment.heads_m[i] - moment.heads_m[person]).norm() < kReach_m)
        others.push_back(moment.heads_m[i]);
    }
    const std::optional<VoronoiCell> cell = cells->cell(moment.heads_m[person], others);
    return cell ? cell->area_m2 : 0;
  };
}

std::optional<DensitySpeed> density_and_speed(const Moment& moment, const Velocities& velocities,
                                              const Rectangle& area, const CellOf& cell) {
  double cell_sum = 0, weighted_mps = 0;
  int people = 0;
  for (size_t person = 0; person < moment.present.size(); ++person) {
    if (velocities.known[person] == 0 || !area.contains(moment.heads_m[person])) continue;
    const double cell_area = cell(moment, person);
    if (cell_area <= 0) continue;
    ++people;
    cell_sum += cell_area;
    weighted_mps += cell_area * velocities.of_mps[person].norm();
  }
  if (people == 0) return std::nullopt;
  return DensitySpeed{people / cell_sum, weighted_mps / cell_sum};
}

AreaSpeeds::AreaSpeeds(const Trial& trial, CellOf cell, std::vector<Rectangle> areas)
    : cell_(std::move(cell)), areas_(std::move(areas)), crowd_(trial.size(), 3) {}

void AreaSpeeds::watch(const Trial& trial, bool counts) {
  if (!clock_.is_due(trial.now_s())) return;
  take(trial, crowd_.next());
  crowd_.pushed();
  if (!counts) return;
  velocities_.find(crowd_, 1, kSample_s);
  for (const Rectangle& area : areas_)
    if (const auto sample = density_and_speed(crowd_.ago(1), velocities_, area, cell_))
      samples_.push_back(*sample);
}

namespace {

// Both loops are 26 m long along their centre lines.
constexpr Oval kSingleFile = {6.4, 1.7, 0.8};
constexpr Oval kCorridor = {6.4, 1.2, 1.8};
constexpr int kFileCounts[] = {8, 14, 20, 25, 30, 35, 40, 46, 52, 58, 64, 70};
constexpr int kCorridorCounts[] = {5, 10, 20, 30, 40, 50, 60, 75, 90, 105, 120, 140, 160};
constexpr double kSettle_s = 60;
constexpr double kRound_s = 180;  ///< end of loop runs

// {entrance, exit}: first only the entrance is narrow, then only the exit.
constexpr double kThrough_m[][2] = {{0.8, 3.0}, {1.2, 3.0}, {1.8, 3.0}, {2.4, 3.0}, {3.0, 3.0},
                                    {3.0, 2.0}, {3.0, 1.6}, {3.0, 1.2}, {3.0, 0.8}};
constexpr double kEntrances_m[] = {0.5, 0.8, 1.0, 1.5, 2.0, 2.4};
constexpr double kTwoWayEntrances_m[] = {0.5, 0.8, 1.2, 1.6, 2.0, 2.5};
constexpr double kEmptying_s = 300;  ///< longest duration of other runs
constexpr double kFirst_s = 10;      ///< time from the first arrival to the first sample
constexpr int kPeople = 200;
constexpr int kJammed = 400;  ///< more people for a narrow exit, to last for the whole run

constexpr double kWall_m = Plan::kWall_m;
/// Depth of waiting areas at a density of 1.7 per m2.
constexpr double kDepth_m = 12;
constexpr double kHalf_m = 5;

Distribution desired_speed(const std::string& id) {
  const RecordedCurve& curve = recorded_curve(id);
  return normal(curve.desired_speed_mps, curve.desired_std_dev_mps());
}

RecordedRun round_run(const std::string& id, const Oval& oval, int people,
                      const SteeringRule& steering, uint64_t seed) {
  RecordedRun run{oval.plan(id, steering, seed), {}, {}, oval, kRound_s};
  oval.populate(run.plan, people, desired_speed(id), false);
  // The measured length equals the corridor's width; 3 m in single file.
  const double half_m = id == "ug" ? 0.5 * oval.width_m : 1.5;
  run.areas = {{{-half_m, oval.inner_m}, {half_m, oval.outer_m()}},
               {{-half_m, -oval.outer_m()}, {half_m, -oval.inner_m}}};
  return run;
}

/// Two waiting rectangles at an entrance at x, on its left (sign 1) or right (sign -1) side.
std::vector<Rectangle> place_to_wait(double x, double middle_y, double entrance_m, double sign,
                                     int people = kPeople) {
  const double depth_m = kDepth_m * people / kPeople;
  const auto between = [&](double from, double to, double half_m) -> Rectangle {
    return {{std::min(x - sign * from, x - sign * to), middle_y - half_m},
            {std::max(x - sign * from, x - sign * to), middle_y + half_m}};
  };
  return {between(kWall_m, kWall_m + depth_m, kHalf_m), between(0, kWall_m, 0.5 * entrance_m)};
}

void add(std::vector<Rectangle>& open, const std::vector<Rectangle>& more) {
  open.insert(open.end(), more.begin(), more.end());
}

/// A corridor 3 m wide from x = 0 to 8 behind a room of 4 m.
RecordedRun one_way_run(double entrance_m, double exit_m, const SteeringRule& steering,
                        uint64_t seed) {
  const int people = exit_m < 3 ? kJammed : kPeople;
  const std::vector<Rectangle> wait = place_to_wait(-4, 0, entrance_m, 1, people);
  std::vector<Rectangle> open = {{{-4, -2.5}, {0, 2.5}},
                                 {{0, -1.5}, {8, 1.5}},
                                 {{8, -0.5 * exit_m}, {8 + kWall_m, 0.5 * exit_m}},
                                 {{8 + kWall_m, -2.5}, {13, 2.5}}};
  add(open, wait);
  RecordedRun run{carved("uo", open, steering, seed), {}, {wait.front()}, {}, kEmptying_s};
  run.plan.people_packed(people, wait.front(), {{{12, -2.5}, {13, 2.5}}}).speed_mps =
      desired_speed("uo");
  run.areas = {{{2.5, -1.5}, {5.5, 1.5}}};
  return run;
}

/// Legs of 5 m along x and 8 m along y, 2.4 m wide.
RecordedRun corner_run(double entrance_m, const SteeringRule& steering, uint64_t seed) {
  const std::vector<Rectangle> wait = place_to_wait(0, 1.2, entrance_m, 1);
  std::vector<Rectangle> open = {
      {{0, 0}, {7.4, 2.4}}, {{5, 0}, {7.4, 10.4}}, {{4, 10.4}, {8.4, 13}}};
  add(open, wait);
  RecordedRun run{carved("eo", open, steering, seed), {}, {wait.front()}, {}, kEmptying_s};
  run.plan.people_packed(kPeople, wait.front(), {{{4, 12.2}, {8.4, 13}}}).speed_mps =
      desired_speed("eo");
  run.areas = {{{1.3, 0}, {3.7, 2.4}}, {{5, 5.2}, {7.4, 7.6}}};
  return run;
}

/// Two arms of 8 m along x, and a stem along y.
RecordedRun junction_run(double entrance_m, const SteeringRule& steering, uint64_t seed) {
  const std::vector<Rectangle> left = place_to_wait(-9.2, 1.2, entrance_m, 1);
  const std::vector<Rectangle> right = place_to_wait(9.2, 1.2, entrance_m, -1);
  std::vector<Rectangle> open = {
      {{-9.2, 0}, {9.2, 2.4}}, {{-1.2, 0}, {1.2, 10.4}}, {{-2.2, 10.4}, {2.2, 13}}};
  add(open, left);
  add(open, right);
  RecordedRun run{
      carved("ko", open, steering, seed), {}, {left.front(), right.front()}, {}, kEmptying_s};
  for (const Rectangle& from : run.waiting)
    run.plan.people_packed(kPeople / 2, from, {{{-2.2, 12.2}, {2.2, 13}}}).speed_mps =
        desired_speed("ko");
  run.areas = {{{-6.4, 0}, {-4, 2.4}}, {{4, 0}, {6.4, 2.4}}, {{-1.2, 5.2}, {1.2, 7.6}}};
  return run;
}

/// A corridor 3.6 m wide from x = 0 to 8, with a room of 4 m at both ends and exits to the sides.
RecordedRun two_way_run(double entrance_m, const SteeringRule& steering, uint64_t seed) {
  const std::vector<Rectangle> left = place_to_wait(-4, 0, entrance_m, 1);
  const std::vector<Rectangle> right = place_to_wait(12, 0, entrance_m, -1);
  std::vector<Rectangle> open = {
      {{-4, -4.8}, {0, 4.8}}, {{0, -1.8}, {8, 1.8}}, {{8, -4.8}, {12, 4.8}}};
  add(open, left);
  add(open, right);
  RecordedRun run{
      carved("bot", open, steering, seed), {}, {left.front(), right.front()}, {}, kEmptying_s};
  const auto sides = [](double from_x) -> std::vector<Rectangle> {
    return {{{from_x, 4}, {from_x + 4, 4.8}}, {{from_x, -4.8}, {from_x + 4, -4}}};
  };
  run.plan.people_packed(kPeople, left.front(), sides(8)).speed_mps = desired_speed("bot");
  run.plan.people_packed(kPeople, right.front(), sides(-4)).speed_mps = desired_speed("bot");
  run.areas = {{{2.2, -1.8}, {5.8, 1.8}}};
  return run;
}

/// Single file: half the distance to the person ahead plus half of that behind.
CellOf lengths_along(const Oval& oval) {
  return [oval](const Moment& moment, size_t person) {
    const double length = oval.length_m();
    const double own = oval.along_m(moment.heads_m[person]);
    double ahead = length, behind = length;
    for (size_t i = 0; i < moment.present.size(); ++i) {
      if (i == person || moment.present[i] == 0) continue;
      const double gap_m = std::fmod(oval.along_m(moment.heads_m[i]) - own + length, length);
      ahead = std::min(ahead, gap_m);
      behind = std::min(behind, length - gap_m);
    }
    return 0.5 * (ahead + behind);
  };
}

int setting_count(const std::string& id) {
  if (id == "single_file") return static_cast<int>(std::size(kFileCounts));
  if (id == "ug") return static_cast<int>(std::size(kCorridorCounts));
  if (id == "uo") return static_cast<int>(std::size(kThrough_m));
  if (id == "bot") return static_cast<int>(std::size(kTwoWayEntrances_m));
  if (id == "eo" || id == "ko") return static_cast<int>(std::size(kEntrances_m));
  throw std::out_of_range("no setup " + id);
}

/// Number of repetitions. Loop runs yield many samples; in other runs few people pass in seconds,
/// and the walking lanes of two streams differ between crowds.
int repetitions(const std::string& id) {
  if (id == "ug") return 1;
  return id == "bot" ? 6 : 3;
}

}  // namespace

int recorded_runs(const std::string& id) { return repetitions(id) * setting_count(id); }

RecordedRun recorded_run(const std::string& id, int run, const Conditions& conditions) {
  const SteeringRule steering{conditions.model};
  const int index = run % setting_count(id);
  const uint64_t seed = conditions.seed_of_run(static_cast<uint64_t>(run / setting_count(id)),
                                               static_cast<uint64_t>(repetitions(id)));
  if (id == "single_file") return round_run(id, kSingleFile, kFileCounts[index], steering, seed);
  if (id == "ug") return round_run(id, kCorridor, kCorridorCounts[index], steering, seed);
  if (id == "uo") return one_way_run(kThrough_m[index][0], kThrough_m[index][1], steering, seed);
  if (id == "eo") return corner_run(kEntrances_m[index], steering, seed);
  if (id == "ko") return junction_run(kEntrances_m[index], steering, seed);
  if (id == "bot") return two_way_run(kTwoWayEntrances_m[index], steering, seed);
  throw std::out_of_range("no setup " + id);
}

std::vector<DensitySpeed> speeds_of(const RecordedRun& run, const std::string& id,
                                    Outcome& outcome) {
  const auto within = [](const Trial& trial, const std::vector<Rectangle>& areas) {
    for (size_t person = 0; person < trial.size(); ++person)
      for (const Rectangle& area : areas)
        if (trial.is_present(person) && area.contains(trial.position_m(person))) return true;
    return false;
  };
  Trial trial(run.plan);
  AreaSpeeds speeds(trial,
                    id == "single_file" ? lengths_along(*run.oval) : voronoi_cells(run.plan.scene),
                    run.areas);
  double begin_s = run.oval ? kSettle_s : std::numeric_limits<double>::infinity();
  while (trial.step(run.end_s)) {
    if (std::isinf(begin_s) && within(trial, run.areas)) begin_s = trial.now_s() + kFirst_s;
    if (!run.waiting.empty() && !within(trial, run.waiting)) break;
    speeds.watch(trial, trial.now_s() >= begin_s);
    if (run.oval) outcome.wall_crossings += run.oval->strays(trial);
  }
  note(outcome, trial);
  return speeds.samples();
}

}  // namespace throng::validation
