// What has to be known of a log before its poses are culled again.
// One rule: the log is read once from end to end, and nothing is kept that grows with its frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/check_spans.h"
#include "recordings/recording.h"
#include "scenes/run/body_kinds.h"

namespace throng {

/// Where states were lost, people stand as before; after longer holes than this the log is over.
inline constexpr double kMaxBridgedGap_s = 10;

struct LogSurvey {
  std::filesystem::path file;
  run_description_t description;
  std::vector<DamagedSpan> damage;  ///< see LogReport

  int64_t states = 0;       ///< frames of the log that have states
  int64_t steps = 0;        ///< those and the ones that are missing between them
  double every = 1;         ///< frames of the log from states to states, in the mean
  double step_s = 0;        ///< from states to states
  int64_t first_frame = 0;  ///< with states, as in the log
  int64_t last_frame = 0;
  bool is_open = false;  ///< somebody is absent at some time
  uint64_t hash = 0;     ///< of all that is posed, see LogStates::hash()
  std::vector<Anomaly> anomalies;
  std::vector<std::string> notes;  ///< for the user, a line each
  /// By model and column, over all people and frames; empty spans of a model that nobody has.
  std::vector<std::vector<ColumnSpan>> spans;
};

/// Steps from states to the next: one, unless some are missing between them.
int64_t steps_between(int64_t frames, bool is_hole, double every);

/// Throws InputError, one line that names the file, if nothing in it can be culled.
LogSurvey survey_log(const std::filesystem::path& file);

}  // namespace throng
