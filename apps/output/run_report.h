// RunReport is the result of `throng run`, printed as a table for people and as JSON.
// Invariant: both print the same summary; names of figures include their units.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/contacts/contact_statistics.h"
#include "lcm_io/replay/run_source.h"
#include "lcm_io/wire/filtered_channels.h"
#include "lcm_io/wire/lockstep.h"
#include "lcm_io/wire/crowd_change_receiver.h"
#include "lcm_io/wire/pose_command_receiver.h"
#include "scenes/run/runner.h"
#include "scenes/separation/separation_monitor.h"

namespace throng {

struct RunReport {
  std::string scene;
  uint64_t seed = 0;
  double step_s = 0;
  int threads = 1;
  std::string simd;
  std::optional<double> budget_ms;
  std::optional<uint64_t> budget_tests;
  SteeringRule steering;
  RunSummary summary;

  struct Lcm {
    std::string url;  ///< "off" if nothing was sent
    int64_t messages = 0;
    int64_t bytes = 0;
    int64_t dropped = 0;
  };
  Lcm lcm;
  std::vector<FilteredChannels::PublishedTotals> filtered_channels;  ///< one per --publish-for
  struct Pace {
    double factor = 0;  ///< target real-time factor; 0: unlimited
    int64_t late_frames = 0;
    double worst_s = 0;
    double behind_s = 0;  ///< lateness of the last frame
  };
  Pace pace;
  std::optional<CrowdChangeReceiver::Counts> crowd_changes;  ///< empty: no change_channel
  std::vector<PoseCommandReceiver::Counts>
      external_control;  ///< one per externally controlled group, without lockstep
  struct LockstepReport {
    std::vector<Lockstep::Counts> groups;
    double timeout_s = 0;
    double total_wait_s = 0;  ///< time spent waiting for replies, over all frames
    double max_wait_s = 0;    ///< longest wait of a frame
    std::string failure;      ///< reason for the end, or ""
  };
  std::optional<LockstepReport> lockstep;  ///< with --lockstep
  std::string log;                         ///< path, or "off"
  uint64_t log_bytes = 0;

  struct Contacts {
    std::string folder;
    ContactTotals totals;
  };
  std::optional<Contacts> contacts;  ///< with --contacts only

  struct Separation {
    std::string folder;  ///< folder of --separation, or ""
    SeparationTotals totals;
  };
  std::optional<Separation> separation;  ///< if the scene has one

  using Recording = RunSource::Recording;
  std::optional<Recording> recording;

  /// Agents of one group that cannot reach one of its goals, at the end.
  struct Stranded {
    std::string group;
    uint32_t goal = 0;  ///< from 1
    int people = 0;
  };
  std::vector<Stranded> stranded;
  double scale_factor = 1;  ///< factor by which --avatars scaled the ground
  Eigen::Vector2d ground_m = Eigen::Vector2d::Zero();
  std::vector<std::string> notes;  ///< notes printed while the run was prepared
};

/// A table with a row per stage, then one line each for time, events, log, messages and hash.
std::string format_table(const RunReport& report);

/// Indented JSON with a final line feed.
std::string json_text(const RunReport& report);

}  // namespace throng
