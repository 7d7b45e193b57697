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
  /// Reads up to the first complete run description, before an export writes anything. Throws
  /// InputError without one, or if the file is not a log. Calls `keep_going` per message;
  /// is_stopped() is true after it returned false.
  ExportedLog(const std::filesystem::path& file, const std::function<bool()>& keep_going);
  bool is_stopped() const { return is_stopped_; }

  /// Reads the next sound message, starting at the beginning of the log; skips damage. Returns
  /// false at the end.
  bool next();
  /// Returns the effect of the message on run().
  RunReader::Update update() const { return update_; }
  const LogEvent& event() const { return event_; }
  RunReader& run() { return run_; }
  /// Throws InputError if the message belongs to another run than those before.
  void require_one_run() const;

  double share_read() const;
  /// Returns sentences on missing parts of the run, or "".
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
  std::pair<int64_t, int64_t> first_;
};

}  // namespace throng
