// One frame of a log: where every part is and which of them touch.
// One rule: nothing but the log is read, so that a log from another machine looks the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_gaps.h"

namespace throng {

/// Throws InputError if nobody is in a run: there is nothing to show. `where`: the file that has
/// it, or where it is heard.
void require_people(const run_description_t& run, const std::string& where);

/// The run as it was at the end of a frame. Where states were recorded more rarely, the crowd is
/// that of the latest frame before.
class RecordedFrame {
 public:
  /// Reads the log up to the end of frame `number`. Throws InputError if the file is no log, has no
  /// description, does not reach so far, or has no states until then.
  RecordedFrame(const std::filesystem::path& log, int64_t number);

  /// Goes on to a later frame. Throws InputError if the log does not reach so far.
  void advance_to(int64_t number);

  /// What of the run the log lacks, in sentences, or "". Reads on to the end: nothing but this may
  /// be asked afterwards.
  std::string describe_missing();

  /// The next frame after the one advanced to that has states, if the log has one. Reads on:
  /// nothing but this and describe_missing() may be asked afterwards.
  std::optional<int64_t> next_states();

  RunReader& run() { return run_; }
  const CrowdState& crowd() const { return run_.state(); }
  const RunReader::Touching& touching() const { return run_.touching(); }

 private:
  std::filesystem::path log_;
  LogReader reader_;
  LogGaps gaps_;
  int64_t last_frame_ = -1;
  RunReader run_;
};

}  // namespace throng
