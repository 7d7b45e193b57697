// The poses of the first run in a log, moment after moment.
// One rule: any file may be one; what checksums disprove is left out, and what is missing between
// two moments is known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/checksum.h"
#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/check_spans.h"
#include "lcm_io/log/log_reader.h"

namespace throng {

class LogStates {
 public:
  /// `damage`: see LogReport. Throws InputError if the file is no log.
  explicit LogStates(const std::filesystem::path& file, std::vector<DamagedSpan> damage = {});

  /// Goes on to the next states. False, and everything stays as it is, if the run has no more.
  bool next();

  /// Its description is there from the first states on.
  RunReader& run() { return run_; }
  const CrowdState& state() const { return run_.state(); }
  /// Frames of the log since the states before; 0 at the first.
  int64_t frames_since() const { return frames_since_; }
  /// Whether states are missing between those before and these, by the numbers of their messages.
  bool is_behind_gap() const { return is_behind_gap_; }
  /// Of all poses so far, and of whose they are; neither of when nor by whom they were written.
  uint64_t hash() const { return hash_.value(); }

  /// What else the log holds, as far as it was read.
  bool has_other_runs() const { return has_other_runs_; }
  /// Bytes that are no message.
  bool is_damaged() const { return is_damaged_; }
  /// Why states or pieces of the description were not taken, the newest; "" if all were.
  const std::string& refusal() const { return refusal_; }

 private:
  bool take(const LogEvent& event);
  bool belongs_to_run(Channel channel, const MessageHeader& header);
  bool is_damaged_at(Channel channel, uint64_t byte);

  LogReader log_;
  RunReader run_;
  std::vector<DamagedSpan> damage_;                ///< in the order of the log
  size_t next_damage_ = 0;                         ///< those before are behind us
  std::optional<std::pair<int64_t, int64_t>> id_;  ///< run id and instance
  bool is_over_ = false;
  bool has_other_runs_ = false;
  bool is_damaged_ = false;
  std::string refusal_;
  int64_t next_seq_ = 0;  ///< of states
  bool has_gap_ = false;
  bool is_behind_gap_ = false;
  int64_t frame_ = -1, frames_since_ = 0;
  Hasher hash_;
};

}  // namespace throng
