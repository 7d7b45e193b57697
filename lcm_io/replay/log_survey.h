// LogSurvey holds the properties of a log that are needed before its poses are culled again.
// Invariant: the log is read once from end to end, in memory that does not grow with its frames.
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

/// Longest gap in which avatars keep their last poses; a longer one ends the log.
inline constexpr double kMaxBridgedGap_s = 10;

struct LogSurvey {
  std::filesystem::path file;
  run_description_t description;
  std::vector<DamagedSpan> damage;

  int64_t states = 0;  ///< frames of the log that have states
  int64_t steps = 0;   ///< `states` plus those missing between them
  double every = 1;
  double step_s = 0;
  int64_t first_frame = 0;  ///< first one with states, numbered as in the log
  int64_t last_frame = 0;
  bool is_open = false;  ///< an avatar is absent at some time
  uint64_t hash = 0;     ///< of all states, see LogStates::hash()
  std::vector<Anomaly> anomalies;
  std::vector<std::string> notes;  ///< for the user, one line each
  /// Posture spans by model and column, over all avatars and frames; empty for an unused model.
  std::vector<std::vector<ColumnSpan>> spans;
};

/// Steps from states to the next: one, or more across a gap.
int64_t steps_between(int64_t frames, bool is_hole, double every);

/// Throws InputError, one line naming the file, if the log cannot be culled.
LogSurvey survey_log(const std::filesystem::path& file);

}  // namespace throng
