// ExportedLog reads the run of a log for an export: first its description, then message by message.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_gaps.h"
#include "lcm_io/log/log_reader.h"

namespace throng {

class ExportedLog {
 public:
  /// Reads as far as the log's first whole description of a run, before an export writes anything.
  /// Throws InputError if it has none, or is no log. `keep_going` is asked message by message;
  /// where it says no, is_stopped() is true.
  ExportedLog(const std::filesystem::path& file, const std::function<bool()>& keep_going);
  bool is_stopped() const { return is_stopped_; }

  /// The next whole message, from the beginning of the log on; damage is skipped. False at the end.
  bool next();
  /// What the message was, and the run as far as it.
  RunReader::Update update() const { return update_; }
  const LogEvent& event() const { return event_; }
  RunReader& run() { return run_; }
  /// Throws InputError if the message is of another run than those before.
  void require_one_run() const;

  /// From 0 to 1.
  double share_read() const;
  /// What of the run the log lacks, in sentences, or "".
  std::string missing() const { return gaps_.describe(step_s_); }

 private:
  std::pair<int64_t, int64_t> id() const { return {run_.run_id(), run_.instance()}; }

  std::filesystem::path file_;
  LogReader reader_;
  LogGaps gaps_;
  RunReader run_;
  LogEvent event_;
  RunReader::Update update_ = RunReader::Update::kNothing;
  double step_s_ = 0;
  bool is_stopped_ = false, has_run_ = false;
  std::pair<int64_t, int64_t> first_;  ///< the run that was described first
};

}  // namespace throng
