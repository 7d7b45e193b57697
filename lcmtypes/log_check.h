// Judges a log: numbering, gaps, fingerprints, and that begins and ends pair up.
// One rule: any file gets a report; nothing in it can crash the judge.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "culling/pair_level.h"
#include "lcmtypes/channels.h"

namespace throng {

struct LogReport {
  struct ChannelReport {
    int64_t messages = 0;
    int64_t bytes = 0;
    int64_t missing = 0;  ///< holes in seq
    int64_t refused = 0;  ///< messages that the guard did not take
  };

  bool torn = false;                  ///< the file ends inside an event
  bool damaged = false;               ///< bytes in the middle that are no event
  bool finished = false;              ///< THRONG_END is there, and its totals agree
  std::vector<std::string> problems;  ///< a line each; at most kMaxProblems
  int64_t problem_count = 0;          ///< also those beyond kMaxProblems
  static constexpr size_t kMaxProblems = 20;

  int64_t log_events = 0;  ///< events of the file: messages of any channel
  uint64_t bytes = 0;
  uint64_t sound_bytes = 0;  ///< of the sound events
  std::array<ChannelReport, kChannelCount> channels{};
  int64_t foreign_messages = 0;  ///< of channels that are not ours

  int64_t begins = 0;
  int64_t ends = 0;
  std::array<int64_t, kPairLevels> begins_by_level{};
  int64_t open_pairs = 0;  ///< begun and not ended when the log stops
  int64_t last_frame = -1;
  int64_t last_utime_us = 0;

  /// Every byte is part of a sound event, nothing is missing, and events pair up. A run that was
  /// cut off between two events is sound without being finished.
  bool is_sound() const { return problem_count == 0; }
};

/// Throws InputError if `file` is no log at all.
LogReport check_log(const std::filesystem::path& file);

/// Copies every sound event of `in` to `out`, byte for byte, and returns how many. Throws
/// InputError, or EnvironmentError if `out` cannot be written or is `in` itself.
int64_t repair_log(const std::filesystem::path& in, const std::filesystem::path& out);

/// A report for people: the run, its channels with rates and sizes, totals, problems.
std::string describe_log(const std::filesystem::path& file);

}  // namespace throng
