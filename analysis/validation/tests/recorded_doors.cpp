// Doors of 0.5 to 2.5 m beside three experiments.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "analysis/validation/recorded_situations.h"

namespace throng::validation {
namespace {

constexpr int kRecorded = 180;
/// One crowd's flow differs from another's by some hundredths.
constexpr uint64_t kCrowds = 3;
constexpr double kEmptiedWithin_s = 600;
constexpr double kRoom_m = 16;
constexpr double kNeck_m = 2.8;
constexpr double kHalf_m = 3;

Figure figure_of(const std::vector<DoorFlow>& flows) {
  std::string ours, theirs;
  for (const DoorFlow& flow : flows)
    ours += fmt::format("{} {:.4f}\n", flow.width_m, flow.flow_per_s);
  for (const RecordedDoor& door : recorded_doors())
    for (const double flow : door.flows_per_s)
      theirs += fmt::format("{} {} {}\n", door.width_m, flow, door.mean_per_s());
  return {"doors", "Flow through a door, by its width",
          std::string("Points: an experiment each. ") + kRecordedDoorsSource + ".",
          "$ours << EOD\n" + ours + "EOD\n$theirs << EOD\n" + theirs +
              fmt::format(
                  "EOD\nset grid\nset key top left\nset xrange [0:2.7]\nset yrange [0:*]\nset "
                  "xlabel 'clear width, m'\nset ylabel 'people per s'\nplot $theirs using "
                  "1:(0.85 * $3) with lines dashtype 2 linecolor rgb '#999999' title '15 % off "
                  "their mean', $theirs using 1:(1.15 * $3) with lines dashtype 2 linecolor rgb "
                  "'#999999' notitle, $theirs with points pointtype 6 linecolor rgb '{}' title "
                  "'recorded', $ours with linespoints linewidth 2 pointtype 7 linecolor rgb '{}' "
                  "title 'simulated'\n",
                  kFigureColours[0], kFigureColours[1])};
}

/// The mean of several crowds, as the experiments' is.
DoorFlow mean_flow(double width_m, const Conditions& conditions, Outcome& outcome) {
  DoorFlow mean = {width_m, 0, 0, 0};
  for (uint64_t run = 0; run < kCrowds; ++run) {
    const DoorFlow flow = pass_a_door(width_m, kRecorded, conditions.model,
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
  const Rectangle room = {{0, -kHalf_m}, {kRoom_m, kHalf_m}};
  const double end_x = kRoom_m + kNeck_m;
  Plan plan = carved("door",
                     {room,
                      {{kRoom_m, -0.5 * width_m}, {end_x, 0.5 * width_m}},
                      {{end_x, -kHalf_m}, {end_x + 5, kHalf_m}}},
                     {model}, seed);
  plan.people_packed(people, room, {{{end_x + 4, -kHalf_m}, {end_x + 5, kHalf_m}}});
  return plan;
}

DoorFlow pass_a_door(double width_m, int people, SteeringKind model, uint64_t seed,
                     Outcome& outcome) {
  Trial trial(door_plan(width_m, people, model, seed));
  Gate gate(Gate::Along::kX, kRoom_m, -kHalf_m, kHalf_m);
  Gate out(Gate::Along::kX, kRoom_m + kNeck_m, -kHalf_m, kHalf_m);
  while (trial.step(kEmptiedWithin_s)) {
    gate.watch(trial);
    out.watch(trial);
  }
  note(outcome, trial);
  // While there is a crowd before it: neither the first ninth nor the last sixth of the people.
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
       "free speeds and bodies of adults.",
       std::string("within 15 % of the experiments' mean at each width, not falling from a "
                   "width to the next, everybody through within 600 s; source: ") +
           kRecordedDoorsSource,
       doors}};
}

}  // namespace throng::validation
