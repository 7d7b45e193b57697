// recorded_inflow simulates experiments with the recorded times and places of entering.
// Invariant: geometry, times and places are the recording's, steering parameters the defaults. Both
// crowds are measured alike.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/measures/recent_crowd.h"
#include "analysis/measures/speed_and_spacing.h"
#include "analysis/validation/plan.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/validation.h"
#include "recordings/recording.h"

namespace throng::validation {

/// Site of a recording.
struct InflowSite {
  std::string id;
  std::string file;
  /// How to read the file; its folder comes from the conditions.
  RecordingOptions reading;
  Plan plan;  ///< walls and ground, without people
  /// People leave by the goal nearest to their last recorded position.
  std::vector<Rectangle> goals;
  std::optional<Distribution> speed_mps{};
  double min_y = -1e9;  ///< least y of starting positions: distance from the barrier
  /// Distance by which people enter farther back along x than recorded, to form lanes before they
  /// are measured.
  double upstream_m = 0;
};
/// Sites whose contacts and spacing are measured.
inline constexpr std::array<const char*, 3> kInflowSites = {"spacing_corridor", "spacing_door",
                                                            "free_corridor"};
/// One of kInflowSites or `two_way_corridor`; throws std::out_of_range for other ids.
InflowSite inflow_site(const std::string& id, const Conditions& conditions);
/// Reads the recording of a site. Null, with `skipped` set in the outcome, if the conditions name
/// no folder of recordings.
std::shared_ptr<const Recording> recording_of(const InflowSite& site, const Conditions& conditions,
                                              Outcome& outcome);

/// Plan with one person per recorded person, who enters at the recorded time and place or as soon
/// as there is space. If several are present at the first instant, they start anywhere in their
/// bounding rectangle.
Plan with_inflow(const InflowSite& site, const Recording& recording);

/// Receives a crowd at regular times, with the latest moment last.
using OnMoment = std::function<void(const RecentCrowd&)>;
/// Calls `each` every `sample_s` of a recording, with the last `moments` moments.
void watch_recorded(const Recording& recording, double sample_s, size_t moments,
                    const OnMoment& each);
/// Calls `each` for a simulation of the plan, for at most `seconds`.
void watch_steered(const Plan& plan, Trial::Detail detail, double seconds, double sample_s,
                   size_t moments, Outcome& outcome, const OnMoment& each);

/// Spacing of recorded and of simulated people, sampled 10 times per second.
std::vector<SpeedAndSpacing::Spacing> recorded_spacing(const Scene& scene,
                                                       const Recording& recording);
std::vector<SpeedAndSpacing::Spacing> steered_spacing(const Plan& plan, double seconds,
                                                      Outcome& outcome);

}  // namespace throng::validation
