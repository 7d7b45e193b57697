// Comparisons with recordings: speed against density, doors, spacing, counterflow.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "analysis/validation/behaviour_verdicts.h"
#include "analysis/validation/recorded_inflow.h"
#include "analysis/validation/recorded_setups.h"

namespace throng::validation {
namespace {

Figure figure_of(const RecordedCurve& curve, const std::vector<Reading>& readings,
                 const std::string& title, const std::vector<DensitySpeed>& samples) {
  std::string band, simulated, cloud;
  for (size_t i = 0; i < curve.bins.size(); ++i) {
    const double middle = curve.bins[i].from + 0.5 * kRecordedBin;
    band += fmt::format("{} {} {} {}\n", middle, curve.bins[i].mean_mps, curve.bins[i].low_mps,
                        curve.bins[i].high_mps);
    if (readings[i].met) simulated += fmt::format("{} {:.4f}\n", middle, readings[i].simulated);
  }
  const size_t every = std::max<size_t>(1, samples.size() / 400);
  for (size_t i = 0; i < samples.size(); i += every)
    cloud += fmt::format("{:.3f} {:.3f}\n", samples[i].density, samples[i].speed_mps);
  // gnuplot rejects an empty data block.
  if (simulated.empty()) simulated = "-1 -1\n";
  if (cloud.empty()) cloud = "-1 -1\n";
  return {curve.id, title, "Bars: 10 to 90 % of the recording. " + curve.source + ".",
          "$band << EOD\n" + band + "EOD\n$simulated << EOD\n" + simulated +
              "EOD\n$cloud << "
              "EOD\n" +
              cloud +
              fmt::format(
                  "EOD\nset grid\nset xrange [0:*]\nset yrange [0:*]\nset key top right\nset "
                  "xlabel 'people {}'\nset ylabel 'speed, m/s'\nplot $cloud with dots linecolor "
                  "rgb '#999999' notitle, $band using 1:2:3:4 with yerrorbars linewidth 2 "
                  "pointtype 7 pointsize 0.6 linecolor rgb '{}' title 'recorded', $simulated with "
                  "linespoints linewidth 2 pointtype 5 pointsize 0.6 linecolor rgb '{}' title "
                  "'simulated'\n",
                  curve.unit == "per m2" ? "per m^2" : curve.unit, kFigureColours[0],
                  kFigureColours[1])};
}

Outcome speed_against_density(const std::string& id, const std::string& title,
                              const Conditions& conditions) {
  Outcome outcome;
  std::vector<DensitySpeed> samples;
  for (int index = 0; index < recorded_runs(id); ++index) {
    const std::vector<DensitySpeed> more =
        speeds_of(recorded_run(id, index, conditions), id, outcome);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  const RecordedCurve& curve = recorded_curve(id);
  Judgement judgement = judge_speeds(curve, samples);
  outcome.figures = {figure_of(curve, judgement.readings, title, samples)};
  return judged(std::move(outcome), std::move(judgement));
}

struct Described {
  const char* id;
  const char* title;
  const char* setup;
};
constexpr Described kSetUps[] = {
    {"ug", "Speed against density: corridor, closed loop",
     "A corridor 1.8 m wide closes in an oval, centre line of 26 m, straights of 6.4 m; 5 to "
     "160 people, seconds 60 to 180; 1.8 m in the middle of both straights."},
    {"uo", "Speed against density: open corridor, one way",
     "A corridor of 8 m x 3 m behind a room of 4 m; 200 people through an entrance of 0.8 to 3.0 "
     "m, then 400 with an exit of 2.0 to 0.8 m, three times each; 3 m in its middle."},
    {"eo", "Speed against density: round a corner",
     "A corridor 2.4 m wide, legs of 5 and 8 m; 200 people through an entrance of 0.5 to 2.4 m, "
     "three times each; 2.4 m in the middle of both legs."},
    {"ko", "Speed against density: two streams merge",
     "A T-junction, arms 2.4 m wide and 8 m long; 100 people in each of two arms through entrances "
     "of 0.5 to 2.4 m, three times each; 2.4 m in the middle of all three."},
    {"bot", "Speed against density: two-way corridor",
     "A corridor of 8 m x 3.6 m, at both ends a room of 4 m; 200 people each way through entrances "
     "of 0.5 to 2.5 m, six times each; 3.6 m in its middle."},
    {"single_file", "Speed against density: single file",
     "A corridor 0.8 m wide closes in an oval, centre line of 26 m; 8 to 70 people, three "
     "times each, seconds 60 to 180; 3 m in the middle of both straights, density along the "
     "centre line."}};

}  // namespace

std::vector<Test> recorded_speed_tests() {
  std::vector<Test> out;
  for (const Described& each : kSetUps) {
    const RecordedCurve& curve = recorded_curve(each.id);
    out.push_back(
        {{each.id},
         {each.title},
         fmt::format("{} Desired speeds {:g} m/s, standard deviation {:.2f}.", each.setup,
                     curve.desired_speed_mps, curve.desired_std_dev_mps()),
         fmt::format("means of bins of 0.25 {} with 20 samples on average at most 15 % of the "
                     "desired "
                     "speed off, 70 % of them between 10 and 90 % of the recording, half of its "
                     "bins reached; source: {}",
                     curve.unit, curve.source),
         [id = std::string(each.id),
          title = std::string(each.title)](const Conditions& conditions) {
           return speed_against_density(id, title, conditions);
         }});
  }
  return out;
}

namespace {

constexpr int kRecorded = 180;
/// Flows differ between crowds by some hundredths.
constexpr uint64_t kCrowds = 3;
constexpr double kEmptiedWithin_s = 600;
constexpr double kHallLength_m = 16;
constexpr double kNeck_m = 2.8;
constexpr double kHalf_m = 3;

Figure figure_of(const std::vector<DoorFlow>& flows) {
  std::string simulated, recorded;
  for (const DoorFlow& flow : flows)
    simulated += fmt::format("{} {:.4f}\n", flow.width_m, flow.flow_per_s);
  for (const RecordedDoor& door : recorded_doors())
    for (const double flow : door.flows_per_s)
      recorded += fmt::format("{} {} {}\n", door.width_m, flow, door.mean_per_s());
  return {"doors", "Flow through a door, by its width",
          std::string("One point per experiment. ") + kRecordedDoorsSource + ".",
          "$simulated << EOD\n" + simulated + "EOD\n$recorded << EOD\n" + recorded +
              fmt::format(
                  "EOD\nset grid\nset key top left\nset xrange [0:2.7]\nset yrange [0:*]\nset "
                  "xlabel 'clear width, m'\nset ylabel 'people per s'\nplot $recorded using "
                  "1:(0.85 * $3) with lines dashtype 2 linecolor rgb '#999999' title '15 % from "
                  "the mean', $recorded using 1:(1.15 * $3) with lines dashtype 2 linecolor rgb "
                  "'#999999' notitle, $recorded with points pointtype 6 linecolor rgb '{}' title "
                  "'recorded', $simulated with linespoints linewidth 2 pointtype 7 linecolor rgb "
                  "'{}' "
                  "title 'simulated'\n",
                  kFigureColours[0], kFigureColours[1])};
}

/// Mean of several crowds, as for the experiments.
DoorFlow mean_flow(double width_m, const Conditions& conditions, Outcome& outcome) {
  DoorFlow mean = {width_m, 0, 0, 0};
  for (uint64_t run = 0; run < kCrowds; ++run) {
    const DoorFlow flow = measure_door_flow(width_m, kRecorded, conditions.model,
                                            conditions.seed_of_run(run, kCrowds), outcome);
    mean.flow_per_s += flow.flow_per_s / kCrowds;
    mean.through += flow.through;
    mean.people += flow.people;
  }
  return mean;
}

Outcome doors(const Conditions& conditions) {
  Outcome outcome;
  std::vector<DoorFlow> flows;
  for (const RecordedDoor& door : recorded_doors())
    flows.push_back(mean_flow(door.width_m, conditions, outcome));
  outcome.figures = {figure_of(flows)};
  return judged(std::move(outcome), judge_doors(flows));
}

}  // namespace

Plan door_plan(double width_m, int people, SteeringKind model, uint64_t seed) {
  const Rectangle hall = {{0, -kHalf_m}, {kHallLength_m, kHalf_m}};
  const double end_x = kHallLength_m + kNeck_m;
  Plan plan = carved("door",
                     {hall,
                      {{kHallLength_m, -0.5 * width_m}, {end_x, 0.5 * width_m}},
                      {{end_x, -kHalf_m}, {end_x + 5, kHalf_m}}},
                     {model}, seed);
  plan.people_packed(people, hall, {{{end_x + 4, -kHalf_m}, {end_x + 5, kHalf_m}}});
  return plan;
}

DoorFlow measure_door_flow(double width_m, int people, SteeringKind model, uint64_t seed,
                           Outcome& outcome) {
  Trial trial(door_plan(width_m, people, model, seed));
  Gate gate(Gate::Along::kX, kHallLength_m, -kHalf_m, kHalf_m);
  Gate out(Gate::Along::kX, kHallLength_m + kNeck_m, -kHalf_m, kHalf_m);
  while (trial.step(kEmptiedWithin_s)) {
    gate.watch(trial);
    out.watch(trial);
  }
  note(outcome, trial);
  // Only while a crowd waits: without the first ninth and the last sixth of the people.
  std::vector<double> times = gate.times_s();
  const auto skipped = static_cast<size_t>(people / 9);
  const auto last = static_cast<size_t>(people - people / 6);
  if (times.size() > last) times.resize(last);
  times.erase(times.begin(),
              times.begin() + static_cast<ptrdiff_t>(std::min(skipped, times.size())));
  return {width_m, flow_per_s(times), static_cast<int>(out.passages().size()), people};
}

std::vector<Test> recorded_door_tests() {
  return {
      {{"doors"},
       {"Doors of 0.5 to 2.5 m"},
       "180 people in a room of 16 m x 6 m, a neck of 2.8 m in the middle of a short side, 0.5 "
       "to 2.5 m wide; flow into the neck from the 21st to the 150th, the mean of three crowds; "
       "desired speeds and bodies of adults.",
       std::string("within 15 % of the experiments' mean at each width, no fall from a "
                   "width to the next, all people through within 600 s; source: ") +
           kRecordedDoorsSource,
       doors}};
}

namespace {

/// Maximum duration of runs with the recorded inflow.
constexpr double kThroughWithin_s = 300;
/// Distances differ between crowds by 1 or 2 cm.
constexpr uint64_t kSpacingCrowds = 3;

using Spacings = std::vector<SpeedAndSpacing::Spacing>;

/// Mean over crowds, weighted by number of pairs.
Spacings mean_of(const std::vector<Spacings>& crowds) {
  Spacings mean = crowds.front();
  for (size_t cell = 0; cell < mean.size(); ++cell) {
    uint64_t pairs = 0;
    decltype(mean[cell].quantiles_m) sums{};
    for (const Spacings& crowd : crowds) {
      pairs += crowd[cell].pairs;
      for (size_t k = 0; k < sums.size(); ++k)
        sums[k] += static_cast<double>(crowd[cell].pairs) * crowd[cell].quantiles_m[k];
    }
    mean[cell].pairs = pairs / crowds.size();
    for (size_t k = 0; k < sums.size() && pairs > 0; ++k)
      mean[cell].quantiles_m[k] = sums[k] / static_cast<double>(pairs);
  }
  return mean;
}

Outcome spacing(const std::string& id, const Conditions& conditions) {
  Outcome outcome;
  const InflowSite site = inflow_site(id, conditions);
  const auto recording = recording_of(site, conditions, outcome);
  if (recording == nullptr) return outcome;
  const auto recorded = recorded_spacing(site.plan.scene, *recording);
  std::vector<Spacings> simulated;
  for (uint64_t crowd = 0; crowd < kSpacingCrowds; ++crowd) {
    const InflowSite again = inflow_site(id, conditions.of_run(crowd, kSpacingCrowds));
    simulated.push_back(steered_spacing(with_inflow(again, *recording), kThroughWithin_s, outcome));
  }
  return judged(std::move(outcome), judge_spacing(mean_of(simulated), recorded));
}

constexpr const char* kCriterion =
    "of the distances to others within 1.2 m, by density and side, 5 and 25 % within 0.08 m of the "
    "recording and 1 % within 0.12 m, in cells with 500 pairs, half of the recording's reached, "
    "as the mean of three crowds; source: {} of the Pedestrian Dynamics Data Archive";

}  // namespace

std::vector<Test> spacing_tests() {
  return {
      {{"spacing_corridor"},
       {"Spacing in a corridor with an exit of 1.2 m"},
       "A corridor of 8 m x 1.8 m with an exit of 1.2 m behind a room; 170 people enter when and "
       "where the recorded ones did. Positions of heads, 10 times per "
       "second.",
       fmt::format(fmt::runtime(kCriterion), "uo-180-180-120 (Hermes project)"),
       [](const Conditions& conditions) { return spacing("spacing_corridor", conditions); }},
      {{"spacing_door"},
       {"Spacing before a door of 0.5 m"},
       "A door of 0.5 m in a barrier; 75 people who start in the rectangle where those of the "
       "recording did.",
       fmt::format(fmt::runtime(kCriterion), "040_c_56_h- (Wuppertal 2018)"),
       [](const Conditions& conditions) { return spacing("spacing_door", conditions); }}};
}

namespace {

constexpr double kWidth_m = 4;
Rectangle middle() { return {{-3, 0}, {2.2, kWidth_m}}; }
/// Walking lanes form at different places in different crowds.
constexpr uint64_t kCorridorCrowds = 3;

class WidthMeter {
 public:
  static constexpr double kSample_s = AreaSpeeds::kSample_s;
  static constexpr size_t kMoments = 3;

  explicit WidthMeter(const Scene& scene) : cell_(voronoi_cells(scene)) {}

  void take(const RecentCrowd& crowd) {
    velocities_.find(crowd, 1, kSample_s);
    const Moment& moment = crowd.ago(1);
    if (const auto sample = density_and_speed(moment, velocities_, middle(), cell_))
      use_.speeds.push_back(*sample);
    std::vector<size_t> there;
    for (size_t person = 0; person < moment.present.size(); ++person)
      if (velocities_.known[person] != 0 && middle().contains(moment.heads_m[person]))
        there.push_back(person);
    for (const size_t person : there) {
      use_.from_right_wall_m.push_back(moment.heads_m[person].y());
      int same = 0, all = 0;
      for (const size_t other : there) {
        if (other == person || std::abs(moment.heads_m[other].y() - moment.heads_m[person].y()) >=
                                   CounterflowUse::kAbreast_m)
          continue;
        ++all;
        same += (velocities_.of_mps[other].x() > 0) == (velocities_.of_mps[person].x() > 0);
      }
      if (all > 0) use_.lane_orders.push_back(std::pow(2.0 * same / all - 1, 2));
    }
  }
  CounterflowUse use() && { return std::move(use_); }

 private:
  CellOf cell_;
  Velocities velocities_;
  CounterflowUse use_{kWidth_m, {}, {}, {}};
};

CounterflowUse recorded_use(const InflowSite& site, const Recording& recording) {
  WidthMeter meter(site.plan.scene);
  watch_recorded(recording, WidthMeter::kSample_s, WidthMeter::kMoments,
                 [&](const RecentCrowd& crowd) { meter.take(crowd); });
  return std::move(meter).use();
}

CounterflowUse steered_use(const Plan& plan, Outcome& outcome) {
  WidthMeter meter(plan.scene);
  watch_steered(plan, Trial::Detail::kPositions, kThroughWithin_s, WidthMeter::kSample_s,
                WidthMeter::kMoments, outcome,
                [&](const RecentCrowd& crowd) { meter.take(crowd); });
  return std::move(meter).use();
}

Outcome two_way_corridor(const Conditions& conditions) {
  Outcome outcome;
  const InflowSite site = inflow_site("two_way_corridor", conditions);
  const auto recording = recording_of(site, conditions, outcome);
  if (recording == nullptr) return outcome;
  CounterflowUse simulated{kWidth_m, {}, {}, {}};
  for (uint64_t crowd = 0; crowd < kCorridorCrowds; ++crowd) {
    const InflowSite again =
        inflow_site("two_way_corridor", conditions.of_run(crowd, kCorridorCrowds));
    simulated.add(steered_use(with_inflow(again, *recording), outcome));
  }
  return judged(std::move(outcome),
                judge_counterflow_use(simulated, recorded_use(site, *recording)));
}

}  // namespace

std::vector<Test> counterflow_corridor_tests() {
  return {{{"two_way_corridor"},
           {"Two streams use the width of a corridor"},
           "A corridor of 9.2 m x 4 m; 480 people enter where and when the recorded ones did, "
           "but 5 m before; three crowds; positions in its middle 5.2 m, twice per second.",
           "within 0.4 m of a wall at most twice the recorded share of the time; in the central "
           "metre at least three quarters of it; lane order (squared difference of the shares "
           "of same and opposite direction within 0.5 m to either side, on average) "
           "at most 0.9; speed within 10 % of the recording in bins of 0.25 per m2 with 20 samples "
           "of both; source: bi_corr_400_b_03 of the Pedestrian Dynamics Data Archive",
           two_way_corridor}};
}

}  // namespace throng::validation
