// Experiments walked again: everybody enters when and where a recorded person did, and both crowds
// are measured alike.
// One rule: geometry, times and places are the recording's; how people steer is what everybody
// gets.
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

/// Where a recording was made.
struct InflowSite {
  std::string id;
  std::string file;
  /// Read with these; its folder comes from the conditions.
  RecordingOptions reading;
  Plan plan;                     ///< without people
  std::vector<Rectangle> goals;  ///< each leaves by the one nearest to where it was last seen
  std::optional<Distribution> speed_mps{};
  double min_y = -1e9;  ///< nobody stands nearer to the barrier at first
  /// So much farther back along x than recorded does each enter, to choose its way among others
  /// before it is measured.
  double upstream_m = 0;
};
/// Whose contacts and distances are measured.
inline constexpr std::array<const char*, 3> kInflowSites = {"spacing_corridor", "spacing_door",
                                                            "free_corridor"};
/// One of these or `two_way_corridor`; throws std::out_of_range for others.
InflowSite inflow_site(const std::string& id, const Conditions& conditions);
/// What was recorded there. None, and the outcome is `skipped`, unless the conditions name the
/// folder of the recordings.
std::shared_ptr<const Recording> recording_of(const InflowSite& site, const Conditions& conditions,
                                              Outcome& outcome);

/// One of the plan's people for each of the recording: enters at its first instant and place, or as
/// soon as there is room. Those of the very first instant, if there are several, stand anywhere in
/// the rectangle around them.
Plan with_inflow(const InflowSite& site, const Recording& recording);

/// A crowd at even times, the latest of them last.
using OnMoment = std::function<void(const RecentCrowd&)>;
/// Calls `each` every `sample_s` of the recording, with so many moments to look back at.
void watch_recorded(const Recording& recording, double sample_s, size_t moments,
                    const OnMoment& each);
/// The same of a plan, for at most so many seconds.
void watch_steered(const Plan& plan, Trial::Detail detail, double seconds, double sample_s,
                   size_t moments, Outcome& outcome, const OnMoment& each);

/// Ten times a second.
std::vector<SpeedAndSpacing::Spacing> recorded_spacing(const Scene& scene,
                                                       const Recording& recording);
std::vector<SpeedAndSpacing::Spacing> steered_spacing(const Plan& plan, double seconds,
                                                      Outcome& outcome);

}  // namespace throng::validation
