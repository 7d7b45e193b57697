// How two streams that meet use the width of a corridor, walked again with the recording's inflow.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "analysis/validation/area_speeds.h"
#include "analysis/validation/recorded_inflow.h"

namespace throng::validation {
namespace {

constexpr double kWidth_m = 4;
Rectangle middle() { return {{-3, 0}, {2.2, kWidth_m}}; }
constexpr double kThroughWithin_s = 300;
/// Where lanes form differs from crowd to crowd.
constexpr uint64_t kCorridorCrowds = 3;

/// Measures a crowd moment by moment.
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
                                   TwoWayUse::kAbreast_m)
          continue;
        ++all;
        same += (velocities_.of_mps[other].x() > 0) == (velocities_.of_mps[person].x() > 0);
      }
      if (all > 0) use_.lane_orders.push_back(std::pow(2.0 * same / all - 1, 2));
    }
  }
  TwoWayUse use() && { return std::move(use_); }

 private:
  CellOf cell_;
  Velocities velocities_;
  TwoWayUse use_{kWidth_m, {}, {}, {}};
};

TwoWayUse recorded_use(const InflowSite& site, const Recording& recording) {
  WidthMeter meter(site.plan.scene);
  watch_recorded(recording, WidthMeter::kSample_s, WidthMeter::kMoments,
                 [&](const RecentCrowd& crowd) { meter.take(crowd); });
  return std::move(meter).use();
}

TwoWayUse steered_use(const Plan& plan, Outcome& outcome) {
  WidthMeter meter(plan.scene);
  watch_steered(plan, Trial::With::kPlaces, kThroughWithin_s, WidthMeter::kSample_s,
                WidthMeter::kMoments, outcome,
                [&](const RecentCrowd& crowd) { meter.take(crowd); });
  return std::move(meter).use();
}

Outcome two_way_corridor(const Conditions& conditions) {
  Outcome outcome;
  const InflowSite site = inflow_site("two_way_corridor", conditions);
  const auto recording = recording_of(site, conditions, outcome);
  if (recording == nullptr) return outcome;
  TwoWayUse ours{kWidth_m, {}, {}, {}};
  for (uint64_t crowd = 0; crowd < kCorridorCrowds; ++crowd) {
    const InflowSite again =
        inflow_site("two_way_corridor", conditions.of_run(crowd, kCorridorCrowds));
    ours.add(steered_use(with_inflow(again, *recording), outcome));
  }
  return judged(std::move(outcome), judge_two_way_use(ours, recorded_use(site, *recording)));
}

}  // namespace

std::vector<Test> two_way_corridor_tests() {
  return {
      {{"two_way_corridor"},
       {"Two streams that meet use the width of a corridor"},
       "A corridor of 9.2 m x 4 m; 480 people enter where and when those of the recording did, "
       "but 5 m before, three crowds; places in its middle 5.2 m, twice a second.",
       "within 0.4 m of a wall at most twice the recorded share of the time; in the central "
       "metre at least three quarters of it; lane order (the squared difference of the shares "
       "that go one's own way and against one of those within 0.5 m to either side, on average) "
       "at most 0.9; speed within 10 % of the recording in bins of 0.25 per m2 with 20 samples "
       "of both; source: bi_corr_400_b_03 of the Pedestrian Dynamics Data Archive",
       two_way_corridor}};
}

}  // namespace throng::validation
