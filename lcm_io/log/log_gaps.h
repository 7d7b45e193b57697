// LogGaps reads the whole messages of a log and notes what of its run is missing.
// Invariant: a log that it calls whole ends with the end of its run, and nothing lies before it
// that is no message, is not what the checks say, or has a number that proves a message missing.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lcm_io/codec/channels.h"
#include "lcm_io/log/check_spans.h"
#include "lcm_io/log/log_reader.h"

namespace throng {

/// What next() of a log could not read, and what followed.
struct LogDamage {
  std::string problem;
  uint64_t from = 0;  ///< byte
  uint64_t bytes = 0;
  bool continues = false;  ///< another event follows
  bool is_torn = false;    ///< the file ends inside an event; otherwise bytes are damaged
};
/// That a log ends between two messages without the end of its run: a sentence.
std::string describe_cut(int64_t last_frame, double step_s);

/// Goes to the next event after `status` of next(), which was kTorn or kDamaged. A torn event that
/// others follow is damage: its length was hit.
LogDamage skip_damage(LogReader& log, LogReader::Status status);

class LogGaps {
 public:
  /// The next whole event of `log`; damage before it is skipped and noted. False at the end.
  bool next(LogReader& log, LogEvent& event);

  /// What is missing, in sentences for a person; "" where next() has read a whole log to its end.
  /// `step_s`: of the run, to tell times.
  std::string describe(double step_s) const;
  /// The same without how the log ends: of what is missing or altered before, a sentence each.
  std::vector<std::string> describe_damage() const;
  /// Where bytes are no messages, a torn end included.
  int64_t damaged_places() const { return damaged_places_; }
  /// Where no description of a run was read: what was found instead, for an InputError.
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
  std::string first_refusal_;  // of a message whose header could not be read
  std::array<int64_t, kChannelCount> next_seq_{};
};

}  // namespace throng
