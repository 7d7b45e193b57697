#include "scenes/validation/recorded_inflow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "avatars/mesh/primitives.h"
#include "scenes/measures/recent_crowd.h"
#include "scenes/validation/reality_tables.h"
#include "scenes/validation/set_ups.h"
#include "scenes/validation/trial_moments.h"

namespace throng::validation {
namespace {

constexpr double kSample_s = 0.1;
constexpr double kSlack_s = 1e-9;

/// A room of 3.8 m, a corridor of 8 m x 1.8 m, an exit in its middle. People walk towards -y.
InflowSite corridor(const std::string& id, const std::string& file, double exit_m,
                    const Conditions& conditions) {
  const double middle = 0.9;
  Plan plan = carved("corridor",
                     {{{-1, 4}, {2.8, 8.5}},
                      {{0, -4}, {1.8, 4}},
                      {{middle - 0.5 * exit_m, -4 - Plan::kWall_m}, {middle + 0.5 * exit_m, -4}},
                      {{-1, -7}, {2.8, -4 - Plan::kWall_m}}},
                     {conditions.model}, conditions.seed);
  RecordingOptions reading;
  reading.fps = 16;
  reading.unit_m = 0.01;
  const RecordedCurve& curve = recorded_curve("uo");
  return {id,
          file,
          reading,
          std::move(plan),
          {{-1, -7}, {2.8, -6}},
          normal(curve.free_speed_mps, curve.free_deviation_mps())};
}

/// Everybody is there from the start, behind barriers with a door of 0.5 m whose corners are cut.
InflowSite door(const Conditions& conditions) {
  Plan plan = carved("door",
                     {{{-2.8, 0}, {2.8, 6.7}},
                      {{-0.4, -0.15}, {0.4, 0}},
                      {{-0.25, -1.1}, {0.25, -0.15}},
                      {{-3, -3}, {3, -1.1}}},
                     {conditions.model}, conditions.seed);
  for (const double side : {-1.0, 1.0}) {
    Obstacle corner;
    corner.size_m = {0.21, 0.1, 2.2};
    corner.centre_m = {0.36 * side, -0.11, 1.1};
    corner.heading_rad = 0.25 * std::numbers::pi * side;
    corner.mesh = box_mesh(corner.size_m);
    plan.solid(std::move(corner));
  }
  return {"spacing_door", "040_c_56_h-.txt", {}, std::move(plan), {{-3, -3}, {3, -2}}, {}, 0.3};
}

/// Measures a crowd moment by moment.
class SpacingMeter {
 public:
  SpacingMeter(const Scene& scene, size_t people)
      : half_(Velocities::half_window(kSample_s)), crowd_(people, 2 * half_ + 1), measure_(scene) {}

  Moment& next() { return crowd_.next(); }
  void pushed() {
    crowd_.pushed();
    velocities_.find(crowd_, half_, kSample_s);
    measure_.take(crowd_.ago(half_), velocities_);
  }
  std::vector<SpeedAndSpacing::Spacing> spacings() const { return measure_.spacings(); }

 private:
  size_t half_;
  RecentCrowd crowd_;
  Velocities velocities_;
  SpeedAndSpacing measure_;
};

}  // namespace

InflowSite inflow_site(const std::string& id, const Conditions& conditions) {
  if (id == "spacing_corridor") return corridor(id, "uo-180-180-120.txt", 1.2, conditions);
  if (id == "free_corridor") return corridor(id, "uo-050-180-180.txt", 1.8, conditions);
  if (id == "spacing_door") return door(conditions);
  throw std::out_of_range("no site " + id);
}

std::vector<std::string> recording_files() {
  std::vector<std::string> files;
  for (const char* id : kInflowSites) files.push_back(inflow_site(id, {}).file);
  return files;
}

std::shared_ptr<const Recording> recording_of(const InflowSite& site, const Conditions& conditions,
                                              Outcome& outcome) {
  if (conditions.recordings.empty()) {
    outcome.skipped = true;
    outcome.measured = fmt::format("needs {}: --recordings FOLDER names where it lies", site.file);
    return nullptr;
  }
  RecordingOptions reading = site.reading;
  reading.file = conditions.recordings / site.file;
  return read_recording(reading);
}

Plan with_inflow(const InflowSite& site, const Recording& recording) {
  Plan plan = site.plan;
  // Heads lean towards each other and towards walls farther than discs may.
  const Eigen::Vector2d slack = Eigen::Vector2d::Constant(0.15);
  std::vector<Sample> samples;
  // Those of the first instant stand closer together than discs can be placed.
  int at_first = 0;
  Rectangle around = {Eigen::Vector2d::Constant(1e9), Eigen::Vector2d::Constant(-1e9)};
  for (size_t person = 0; person < recording.people().size(); ++person) {
    recording.read(person, samples);
    const Sample& first = samples.front();
    const Rectangle place = {first.position_m - slack, first.position_m + slack};
    if (first.time_s < kSlack_s) {
      ++at_first;
      around.min_m = around.min_m.cwiseMin(place.min_m);
      around.max_m = around.max_m.cwiseMax(place.max_m);
      continue;
    }
    Group& one = plan.people(0, place, {site.goal});
    one.sources = {{place, 1, 1, first.time_s, false}};
    one.speed_mps = site.speed_mps;
  }
  if (at_first > 0) {
    around.min_m.y() = std::max(around.min_m.y(), site.least_y);
    plan.people_packed(at_first, around, {site.goal}).speed_mps = site.speed_mps;
  }
  return plan;
}

std::vector<SpeedAndSpacing::Spacing> recorded_spacing(const Scene& scene,
                                                       const Recording& recording) {
  const size_t people = recording.people().size();
  std::vector<std::vector<Sample>> tracks(people);
  for (size_t person = 0; person < people; ++person) recording.read(person, tracks[person]);
  SpacingMeter meter(scene, people);
  const double end_s = recording.facts().duration_s;
  for (int tenth = 0; tenth * kSample_s <= end_s; ++tenth) {
    Moment& next = meter.next();
    next.time_s = tenth * kSample_s;
    for (size_t person = 0; person < people; ++person) {
      const std::vector<Sample>& track = tracks[person];
      const auto after = std::lower_bound(
          track.begin(), track.end(), next.time_s - kSlack_s,
          [](const Sample& sample, double time_s) { return sample.time_s < time_s; });
      const bool is_there = after != track.end() &&
                            (after != track.begin() || after->time_s <= next.time_s + kSlack_s);
      next.present[person] = is_there;
      if (!is_there) continue;
      const Sample& to = *after;
      const Sample& from = after == track.begin() ? to : *(after - 1);
      const double share =
          to.time_s > from.time_s ? (next.time_s - from.time_s) / (to.time_s - from.time_s) : 1;
      next.heads_m[person] = next.roots_m[person] =
          from.position_m + share * (to.position_m - from.position_m);
    }
    meter.pushed();
  }
  return meter.spacings();
}

std::vector<SpeedAndSpacing::Spacing> steered_spacing(const Plan& plan, double seconds,
                                                      Outcome& outcome) {
  Plan posed = plan;
  posed.scene.step_s = Scene().step_s;
  Trial trial(posed, Trial::With::kBodies);
  SpacingMeter meter(plan.scene, trial.size());
  Every clock(kSample_s);
  do {
    if (!clock.is_due(trial.now_s())) continue;
    take(trial, meter.next());
    meter.pushed();
  } while (trial.step(seconds));
  note(outcome, trial);
  return meter.spacings();
}

}  // namespace throng::validation
