// LogStates reads the poses of the first run in a log, state by state.
// Invariant: any file may be given; states that fail their checksums are left out, and gaps are
// known.
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
  /// `damage`: see LogReport. Throws InputError if the file is not a log.
  explicit LogStates(const std::filesystem::path& file, std::vector<DamagedSpan> damage = {});

  /// Reads the next states. Returns false and changes nothing if the run has no more.
  bool next();

  /// Its description is complete from the first states on.
  RunReader& run() { return run_; }
  const CrowdState& state() const { return run_.state(); }
  /// Frames of the log since the states before; 0 at the first.
  int64_t frames_since() const { return frames_since_; }
  /// Whether states are missing before these, by the numbers of their messages.
  bool is_behind_gap() const { return is_behind_gap_; }
  /// Hash of all poses so far and their models; independent of time and sender.
  uint64_t hash() const { return hash_.value(); }

  /// Whether the log holds other runs, in the part that was read.
  bool has_other_runs() const { return has_other_runs_; }
  bool is_damaged() const { return is_damaged_; }
  /// Reason why states or chunks of the description were last rejected; "" if none were.
  const std::string& rejection() const { return rejection_; }

 private:
  bool take(const LogEvent& event);
  bool belongs_to_run(Channel channel, const MessageHeader& header);
  bool is_damaged_at(Channel channel, uint64_t byte);

  LogReader log_;
  RunReader run_;
  std::vector<DamagedSpan> damage_;  ///< in the order of the log
  size_t next_damage_ = 0;           ///< the first one not passed yet
  std::optional<std::pair<int64_t, int64_t>> id_;
  bool is_over_ = false;
  bool has_other_runs_ = false;
  bool is_damaged_ = false;
  std::string rejection_;
  int64_t next_seq_ = 0;  ///< of states messages
  bool has_gap_ = false;
  bool is_behind_gap_ = false;
  int64_t frame_ = -1, frames_since_ = 0;
  Hasher hash_;
};

}  // namespace throng
