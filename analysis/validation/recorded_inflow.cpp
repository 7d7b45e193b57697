#include "analysis/validation/recorded_inflow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "analysis/validation/empirical_tables.h"
#include "analysis/validation/setups.h"
#include "analysis/validation/trial.h"
#include "avatars/mesh/primitives.h"

namespace throng::validation {
namespace {

constexpr double kInflowSample_s = 0.1;
constexpr double kSlack_s = 1e-9;

/// A room of 3.8 m, a corridor of 8 m x 1.8 m and an exit in its middle. People walk towards -y.
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
          {{{-1, -7}, {2.8, -6}}},
          normal(curve.desired_speed_mps, curve.desired_std_dev_mps())};
}

/// All people start behind barriers with a door of 0.5 m with cut corners.
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
  return {"spacing_door", "040_c_56_h-.txt", {}, std::move(plan), {{{-3, -3}, {3, -2}}}, {}, 0.3};
}

/// Walls of the corridor from x = -5 to 4.2, wider ground before and after it.
InflowSite two_way_corridor(const Conditions& conditions) {
  Plan plan = carved("two_way_corridor",
                     {{{-13, -1}, {-5, 5}}, {{-5, 0}, {4.2, 4}}, {{4.2, -1}, {12.2, 5}}},
                     {conditions.model}, conditions.seed);
  return {"two_way_corridor",
          "bi_corr_400_b_03.txt",
          {},
          std::move(plan),
          {{{-13, -1}, {-12, 5}}, {{11.2, -1}, {12.2, 5}}},
          {},
          -1e9,
          5};
}

/// Position on a track; none before its first and after its last sample.
std::optional<Eigen::Vector2d> place_at(const std::vector<Sample>& track, double time_s) {
  const auto after =
      std::lower_bound(track.begin(), track.end(), time_s - kSlack_s,
                       [](const Sample& sample, double at_s) { return sample.time_s < at_s; });
  if (after == track.end() || (after == track.begin() && after->time_s > time_s + kSlack_s))
    return std::nullopt;
  const Sample& to = *after;
  const Sample& from = after == track.begin() ? to : *(after - 1);
  const double share =
      to.time_s > from.time_s ? (time_s - from.time_s) / (to.time_s - from.time_s) : 1;
  return from.position_m + share * (to.position_m - from.position_m);
}

/// Speed over the first second of a track; none for shorter tracks.
std::optional<double> entry_speed_mps(const std::vector<Sample>& track) {
  constexpr double kOver_s = 1, kMinTime_s = 0.2;
  const Sample& first = track.front();
  size_t last = 0;
  while (last + 1 < track.size() && track[last].time_s < first.time_s + kOver_s) ++last;
  const double over_s = track[last].time_s - first.time_s;
  if (over_s < kMinTime_s) return {};
  return (track[last].position_m - first.position_m).norm() / over_s;
}

size_t closest_goal(const InflowSite& site, const Eigen::Vector2d& place_m) {
  const auto away_m = [&](const Rectangle& goal) {
    return (goal.min_m - place_m).cwiseMax(place_m - goal.max_m).cwiseMax(0).norm();
  };
  return static_cast<size_t>(
      std::min_element(site.goals.begin(), site.goals.end(),
                       [&](const auto& a, const auto& b) { return away_m(a) < away_m(b); }) -
      site.goals.begin());
}

class SpacingMeter {
 public:
  explicit SpacingMeter(const Scene& scene) : measure_(scene) {}

  static size_t moments() { return 2 * half() + 1; }
  void take(const RecentCrowd& crowd) {
    velocities_.find(crowd, half(), kInflowSample_s);
    measure_.take(crowd.ago(half()), velocities_);
  }
  std::vector<SpeedAndSpacing::Spacing> spacings() const { return measure_.spacings(); }

 private:
  static size_t half() { return Velocities::half_window(kInflowSample_s); }

  Velocities velocities_;
  SpeedAndSpacing measure_;
};

}  // namespace

InflowSite inflow_site(const std::string& id, const Conditions& conditions) {
  if (id == "spacing_corridor") return corridor(id, "uo-180-180-120.txt", 1.2, conditions);
  if (id == "free_corridor") return corridor(id, "uo-050-180-180.txt", 1.8, conditions);
  if (id == "spacing_door") return door(conditions);
  if (id == "two_way_corridor") return two_way_corridor(conditions);
  throw std::out_of_range("no site " + id);
}

std::vector<std::string> recording_files() {
  std::vector<std::string> files;
  for (const char* id : kInflowSites) files.push_back(inflow_site(id, {}).file);
  files.push_back(inflow_site("two_way_corridor", {}).file);
  return files;
}

std::shared_ptr<const Recording> recording_of(const InflowSite& site, const Conditions& conditions,
                                              Outcome& outcome) {
  if (conditions.recordings.empty()) {
    outcome.skipped = true;
    outcome.measured = fmt::format("needs {}; set its folder with --recordings FOLDER", site.file);
    return nullptr;
  }
  RecordingOptions reading = site.reading;
  reading.file = conditions.recordings / site.file;
  return read_recording(reading);
}

Plan with_inflow(const InflowSite& site, const Recording& recording) {
  Plan plan = site.plan;
  // Heads lean closer to each other and to walls than discs can be.
  const Eigen::Vector2d slack = Eigen::Vector2d::Constant(0.15);
  std::vector<Sample> samples;
  // People of the first instant stand closer together than discs can be placed.
  int at_first = 0;
  Rectangle around = {Eigen::Vector2d::Constant(1e9), Eigen::Vector2d::Constant(-1e9)};
  for (size_t person = 0; person < recording.people().size(); ++person) {
    recording.read(person, samples);
    const Sample& first = samples.front();
    const size_t goal = closest_goal(site, samples.back().position_m);
    const double ahead = samples.back().position_m.x() < first.position_m.x() ? -1 : 1;
    const Eigen::Vector2d enters_m = first.position_m - Eigen::Vector2d(ahead * site.upstream_m, 0);
    const Rectangle place = {enters_m - slack, enters_m + slack};
    if (first.time_s < kSlack_s) {
      ++at_first;
      around.min_m = around.min_m.cwiseMin(place.min_m);
      around.max_m = around.max_m.cwiseMax(place.max_m);
      continue;
    }
    Group& one = plan.people(0, place, {site.goals[goal]});
    one.sources = {{place, 1, 1, first.time_s, false, entry_speed_mps(samples)}};
    one.speed_mps = site.speed_mps;
  }
  if (at_first > 0) {
    around.min_m.y() = std::max(around.min_m.y(), site.min_y);
    plan.people_packed(at_first, around, site.goals).speed_mps = site.speed_mps;
  }
  return plan;
}

void watch_recorded(const Recording& recording, double sample_s, size_t moments,
                    const OnMoment& each) {
  const size_t people = recording.people().size();
  std::vector<std::vector<Sample>> tracks(people);
  for (size_t person = 0; person < people; ++person) recording.read(person, tracks[person]);
  RecentCrowd crowd(people, moments);
  const double end_s = recording.facts().duration_s;
  for (int sample = 0; sample * sample_s <= end_s; ++sample) {
    Moment& next = crowd.next();
    next.time_s = sample * sample_s;
    for (size_t person = 0; person < people; ++person) {
      const auto place = place_at(tracks[person], next.time_s);
      next.present[person] = place.has_value();
      if (place) next.heads_m[person] = next.roots_m[person] = *place;
    }
    crowd.pushed();
    each(crowd);
  }
}

void watch_steered(const Plan& plan, Trial::Detail detail, double seconds, double sample_s,
                   size_t moments, Outcome& outcome, const OnMoment& each) {
  Trial trial(plan, detail);
  RecentCrowd crowd(trial.size(), moments);
  PeriodTimer clock(sample_s);
  do {
    if (!clock.is_due(trial.now_s())) continue;
    take(trial, crowd.next());
    crowd.pushed();
    each(crowd);
  } while (trial.step(seconds));
  note(outcome, trial);
}

std::vector<SpeedAndSpacing::Spacing> recorded_spacing(const Scene& scene,
                                                       const Recording& recording) {
  SpacingMeter meter(scene);
  watch_recorded(recording, kInflowSample_s, SpacingMeter::moments(),
                 [&](const RecentCrowd& crowd) { meter.take(crowd); });
  return meter.spacings();
}

std::vector<SpeedAndSpacing::Spacing> steered_spacing(const Plan& plan, double seconds,
                                                      Outcome& outcome) {
  Plan posed = plan;
  posed.scene.step_s = Scene().step_s;
  SpacingMeter meter(plan.scene);
  watch_steered(posed, Trial::Detail::kBodies, seconds, kInflowSample_s, SpacingMeter::moments(),
                outcome, [&](const RecentCrowd& crowd) { meter.take(crowd); });
  return meter.spacings();
}

}  // namespace throng::validation
