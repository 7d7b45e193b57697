// LogReport is the result of checking a log: checksums, numbering, gaps, fingerprints, pairing of
// begins and ends, and the hash of events.
// Invariant: any file gets a report, no content crashes the check, and a damaged log is never
// reported as sound.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "culling/pair.h"
#include "lcm_io/codec/channels.h"
#include "lcm_io/log/check_spans.h"

namespace throng {

struct LogReport {
  struct ChannelReport {
    int64_t messages = 0;
    int64_t bytes = 0;
    int64_t missing = 0;   ///< gaps in seq
    int64_t rejected = 0;  ///< messages that failed validation
  };

  bool torn = false;
  bool damaged = false;   ///< bytes in the middle that are not an event
  bool finished = false;  ///< THRONG_END is present, its totals agree, all messages are covered
  std::string cut_off;    ///< a sentence if the log ends between two messages of its run, or ""
  std::vector<std::string> problems;  ///< one line each; at most kMaxProblems
  int64_t problem_count = 0;          ///< including those beyond kMaxProblems
  static constexpr size_t kMaxProblems = 20;

  int64_t log_events = 0;  ///< events of the file: messages of any channel
  uint64_t bytes = 0;
  uint64_t sound_bytes = 0;
  std::array<ChannelReport, kChannelCount> channels{};
  int64_t foreign_messages = 0;  ///< on channels unknown to Throng

  int64_t begins = 0;
  int64_t ends = 0;
  std::array<int64_t, kPairLevels> begins_by_level{};
  int64_t open_pairs = 0;  ///< begun and not ended at the end of the log
  int64_t last_frame = -1;
  int64_t last_utime_us = 0;

  /// Whether THRONG_CHECKSUMS was found; a log cut off before the first frame has none.
  bool has_checks = false;
  int64_t uncovered = 0;  ///< messages after the last checksums, which cover them not
  int64_t checked_frame = -1;
  std::vector<DamagedSpan> damage;  ///< damage proven by checksums, in their order
  bool repaired = false;            ///< `throng check --repair` has left something out
  bool hash_agrees = false;         ///< the events give the hash of THRONG_END

  /// Channels unknown to Throng, in a log that only Throng writes.
  std::set<std::string, std::less<>> unknown_channels;

  /// Properties of the run, printable; "" if the log does not contain them.
  std::string version, commit, strategy, omits;

  /// Every byte is part of a sound event, no message is missing in between, and events pair up. A
  /// run cut off between two events is sound without being finished.
  bool is_sound() const { return problem_count == 0; }
  bool is_complete() const { return is_sound() && finished; }
};

/// Throws InputError if all messages of a log were rejected, the first for `first_rejection`:
/// damage affects some messages, another version all.
void require_this_version(const std::filesystem::path& file, int64_t messages, int64_t rejected,
                          const std::string& first_rejection);

/// Throws InputError if `file` is not a log, or if none of its messages is of this version.
LogReport check_log(const std::filesystem::path& file);

/// Describes how far checksums cover a log, one line each.
std::vector<std::string> describe_coverage(const LogReport& report);

/// Copies each sound message of `in` to `out`, byte for byte, and returns their number. For a
/// channel with damage between two checksum messages nothing is copied from there on. The later
/// checksums are recomputed over the copied messages and marked (is_repaired). If damage remains
/// (pieces of several logs with equal numbers), the copy ends before the first. Throws InputError,
/// or EnvironmentError if `out` cannot be written or is `in` itself.
int64_t repair_log(const std::filesystem::path& in, const std::filesystem::path& out);

/// Returns a report as text: the run, its channels with rates and sizes, totals, problems.
std::string describe_log(const std::filesystem::path& file);

}  // namespace throng
