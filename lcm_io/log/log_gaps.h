// LogGaps reads the sound messages of a log and records which parts of its run are missing.
// Invariant: a log reported as complete ends with the end of its run. Before it there are only
// messages, all match their checksums, and none is missing by number.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lcm_io/codec/channels.h"
#include "lcm_io/log/check_spans.h"
#include "lcm_io/log/log_reader.h"

namespace throng {

/// Damage after a message, and what follows it.
struct LogDamage {
  std::string problem;
  uint64_t from = 0;
  uint64_t bytes = 0;
  bool continues = false;
  bool is_torn = false;  ///< the file ends inside an event; otherwise bytes are damaged
};
/// Returns a sentence for a log that ends between two messages, before the end of its run.
std::string describe_cut(int64_t last_frame, double step_s);

/// Goes to the next event after `status` of next(), which was kTorn or kDamaged. A torn event
/// followed by others is damage in its length field.
LogDamage skip_damage(LogReader& log, LogReader::Status status);

class LogGaps {
 public:
  /// Reads the next sound event of `log`; damage before it is skipped and recorded. False at the
  /// end.
  bool next(LogReader& log, LogEvent& event);

  /// Returns sentences on missing parts; "" after next() has read a complete log. `step_s`: step of
  /// the run, to convert frames to times.
  std::string describe(double step_s) const;
  /// Returns one sentence for each missing or altered part, without the end of the log.
  std::vector<std::string> describe_damage() const;
  /// Number of places whose bytes are not messages, including a torn end.
  int64_t damaged_places() const { return damaged_places_; }
  /// Returns the FOUND part of an InputError for a log without a run description.
  std::string found_no_description() const;

 private:
  void note(const LogEvent& event);
  void compare(const LogEvent& event, const MessageHeader& header);

  bool is_torn_ = false, has_end_ = false, has_run_ = false;
  uint64_t damaged_bytes_ = 0;
  int64_t damaged_places_ = 0;
  CheckSpans spans_;
  size_t damaged_spans_ = 0;
  int64_t missing_ = 0, last_frame_ = -1;
  int64_t run_id_ = 0, instance_ = 0;
  std::string first_rejection_;  // for the first message whose header could not be read
  std::array<int64_t, kChannelCount> next_seq_{};
};

}  // namespace throng
