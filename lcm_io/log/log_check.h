// Judges a log: checksums, numbering, gaps, fingerprints, that begins and ends pair up, and the
// hash of events. One rule: any file gets a report, nothing in it can crash the judge, and what is
// damaged is never called sound.
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
    int64_t missing = 0;  ///< holes in seq
    int64_t refused = 0;  ///< messages that the guard did not take
  };

  bool torn = false;      ///< the file ends inside an event
  bool damaged = false;   ///< bytes in the middle that are no event
  bool finished = false;  ///< THRONG_END is there, its totals agree, nothing is uncovered
  std::string cut_off;    ///< a sentence where the log ends between two messages of its run, or ""
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

  /// Whether THRONG_CHECKSUMS was found; a log that is cut off before the first frame has none.
  bool has_checks = false;
  int64_t uncovered = 0;            ///< messages behind the last checks: nothing vouches for them
  int64_t checked_frame = -1;       ///< of the last checks
  std::vector<DamagedSpan> damage;  ///< what the checks prove, in their order
  bool repaired = false;            ///< `throng check --repair` has left something out
  bool hash_agrees = false;         ///< the events give the hash of THRONG_END

  /// Not ours, in a log that nobody but Throng writes into.
  std::set<std::string, std::less<>> unknown_channels;

  /// Of what made the run, printable; "" where the log does not say it.
  std::string version, commit, strategy, omits;

  /// Every byte is part of a sound event, nothing is missing in between, and events pair up. A run
  /// that was cut off between two events is sound without being finished.
  bool is_sound() const { return problem_count == 0; }
  /// Sound, and finished.
  bool is_complete() const { return is_sound() && finished; }
};

/// Throws InputError where all messages of a log were refused, the first of them for
/// `first_refusal`: damage hits some, another version all.
void require_this_version(const std::filesystem::path& file, int64_t messages, int64_t refused,
                          const std::string& first_refusal);

/// Throws InputError if `file` is no log at all, or if none of its messages is of this version.
LogReport check_log(const std::filesystem::path& file);

/// How far checksums vouch for a log, a line each.
std::vector<std::string> describe_coverage(const LogReport& report);

/// Copies every sound message of `in` to `out`, byte for byte, and returns how many. Of a channel
/// that is damaged somewhere between two checks nothing is copied from there; the checks behind it
/// are made anew over what was copied and say so (is_repaired). Where that leaves damage (pieces of
/// several logs, their numbers repeating), the copy ends before the first of it. Throws InputError,
/// or EnvironmentError if `out` cannot be written or is `in` itself.
int64_t repair_log(const std::filesystem::path& in, const std::filesystem::path& out);

/// A report for people: the run, its channels with rates and sizes, totals, problems.
std::string describe_log(const std::filesystem::path& file);

}  // namespace throng
