// Speed against density in the set-ups in which people were recorded.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "analysis/validation/recorded_set_ups.h"

namespace throng::validation {
namespace {

Figure figure_of(const RecordedCurve& curve, const std::vector<Reading>& readings,
                 const std::string& title, const std::vector<DensitySpeed>& samples) {
  std::string band, ours, cloud;
  for (size_t i = 0; i < curve.bins.size(); ++i) {
    const double middle = curve.bins[i].from + 0.5 * kRecordedBin;
    band += fmt::format("{} {} {} {}\n", middle, curve.bins[i].mean_mps, curve.bins[i].low_mps,
                        curve.bins[i].high_mps);
    if (readings[i].met) ours += fmt::format("{} {:.4f}\n", middle, readings[i].ours);
  }
  const size_t every = std::max<size_t>(1, samples.size() / 400);
  for (size_t i = 0; i < samples.size(); i += every)
    cloud += fmt::format("{:.3f} {:.3f}\n", samples[i].density, samples[i].speed_mps);
  // A block without a line is an error to gnuplot.
  if (ours.empty()) ours = "-1 -1\n";
  if (cloud.empty()) cloud = "-1 -1\n";
  return {curve.id, title, "Bars: 10 to 90 % of the recording. " + curve.source + ".",
          "$band << EOD\n" + band + "EOD\n$ours << EOD\n" + ours + "EOD\n$cloud << EOD\n" + cloud +
              fmt::format(
                  "EOD\nset grid\nset xrange [0:*]\nset yrange [0:*]\nset key top right\nset "
                  "xlabel 'people {}'\nset ylabel 'speed, m/s'\nplot $cloud with dots linecolor "
                  "rgb '#999999' notitle, $band using 1:2:3:4 with yerrorbars linewidth 2 "
                  "pointtype 7 pointsize 0.6 linecolor rgb '{}' title 'recorded', $ours with "
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
    {"ug", "Speed against density: corridor, people go round",
     "A corridor 1.8 m wide closes in an oval, 26 m round in its middle, straights of 6.4 m; 5 to "
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
     "A corridor 0.8 m wide closes in an oval, 26 m round in its middle; 8 to 70 people, three "
     "times each, seconds 60 to 180; 3 m in the middle of both straights, density along the way."}};

}  // namespace

std::vector<Test> recorded_speed_tests() {
  std::vector<Test> out;
  for (const Described& each : kSetUps) {
    const RecordedCurve& curve = recorded_curve(each.id);
    out.push_back(
        {{each.id},
         {each.title},
         fmt::format("{} Free speeds {:g} m/s, standard deviation {:.2f}.", each.setup,
                     curve.free_speed_mps, curve.free_deviation_mps()),
         fmt::format("means of bins of 0.25 {} with 20 samples on average at most 15 % of the free "
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

}  // namespace throng::validation
