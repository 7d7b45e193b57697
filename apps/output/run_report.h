// What `throng run` tells about a run: a table for people, JSON for machines.
// One rule: both say the same, from the same summary; a figure that leaves the process names its
// unit.
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
  std::vector<FilteredChannels::PublishedTotals> filtered_channels;  ///< one a --publish-for
  struct Pace {
    double factor = 0;  ///< simulated seconds a second that were asked for; 0: unpaced
    int64_t late_frames = 0;
    double worst_s = 0;
    double behind_s = 0;  ///< at the end
  };
  Pace pace;
  std::vector<PoseCommandReceiver::Counts>
      external_control;  ///< one a driven group, without lockstep
  struct LockstepReport {
    std::vector<Lockstep::Counts> groups;
    double timeout_s = 0;
    double total_wait_s = 0;  ///< for answers, over all frames
    double max_wait_s = 0;    ///< of a frame
    std::string failure;      ///< why it ended, or ""
  };
  std::optional<LockstepReport> lockstep;  ///< with --lockstep
  std::string log;                         ///< path, or "off"
  uint64_t log_bytes = 0;

  struct Contacts {
    std::string folder;
    ContactTotals totals;
  };
  std::optional<Contacts> contacts;  ///< with --contacts

  struct Separation {
    std::string folder;  ///< of --separation, or ""
    SeparationTotals totals;
  };
  std::optional<Separation> separation;  ///< of a scene that has one

  using Recording = RunSource::Recording;
  std::optional<Recording> recording;

  /// People of one group who cannot reach one of its goals, at the end.
  struct Stranded {
    std::string group;
    uint32_t goal = 0;  ///< from 1
    int people = 0;
  };
  std::vector<Stranded> stranded;
  double scale_factor = 1;  ///< how many times longer --avatars made the plan
  Eigen::Vector2d ground_m = Eigen::Vector2d::Zero();
  std::vector<std::string> notes;  ///< what was said while the run was prepared
};

/// A table with a row for each stage, then a line each for time, events, log, messages and hash.
std::string format_table(const RunReport& report);

/// The same for machines, indented, with a final line feed.
std::string json_text(const RunReport& report);

}  // namespace throng
