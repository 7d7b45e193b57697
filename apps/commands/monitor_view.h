// MonitorView holds what `throng monitor` shows, as text for people or as JSON.
// Invariant: both contain the same; received text is escaped before it reaches a terminal.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lcm_io/wire/monitor.h"

namespace throng {

struct MonitorView {
  const Inbox& inbox;
  const Monitor& monitor;
  std::string source;   ///< URL or file
  double now_s = 0;     ///< time on the clock of Monitor::take()
  bool overall = true;  ///< rates over the whole run; false: over the last seconds
  int width = 100;      ///< columns; longer lines are cut
  int height = 50;      ///< maximum number of lines
};

std::vector<std::string> lines_of(const MonitorView& view);

// The parts of lines_of(). A section begins with the names of its columns.
std::string title_of(const MonitorView& view);
/// Frames, pairs and events per second, and losses.
std::vector<std::string> rate_lines(const MonitorView& view);
std::vector<std::string> channel_lines(const MonitorView& view);
std::vector<std::string> stage_lines(const MonitorView& view);
std::vector<std::string> part_lines(const MonitorView& view, size_t max_lines);

/// One line, for output that cannot be redrawn.
std::string line_of(const MonitorView& view);

nlohmann::ordered_json json_of(const MonitorView& view);

/// A contact as text: "walkers 17 leftHand - walkers 203 torso, 0.4 s".
std::string text_of(const Monitor::Note& note, const run_description_t* run);

/// Stages of Monitor::Totals as the terms of T = N_u C_u + N_v C_v + N_p C_p + C_o, per frame.
struct CostTerms {
  struct Stage {
    std::string volume;
    double n_u = 0, c_u_ns = 0, n_v = 0, c_v_ns = 0, passed = 0;
  };
  std::vector<Stage> stages;  ///< bounding volumes only
  double n_p = 0, c_p_ns = 0;
  double c_o_ns = 0;  ///< time for posing bodies and merging events
  double t_ns = 0;
};
CostTerms cost_terms(const Monitor::Totals& totals, const run_description_t* run);

/// Number of messages of this run that were sent and not received.
int64_t lost_of(const RunTally& run);

}  // namespace throng
