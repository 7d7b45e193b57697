// Inbox receives the messages of all runs on Throng's channels; it follows one run and counts all.
// Invariant: no input stops it or lets its memory grow without bound.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <string_view>

#include "lcm_io/codec/run_reader.h"
#include "lcm_io/codec/tally.h"

namespace throng {

class Inbox {
 public:
  /// Number of runs kept; a new one replaces the run that was silent longest.
  static constexpr size_t kMaxRuns = 32;

  RunReader::Update take(std::string_view channel, std::span<const uint8_t> bytes);

  RunReader& run() { return run_; }
  const RunReader& run() const { return run_; }

  /// All received runs, by run id and instance; the most recent is last.
  const std::deque<RunTally>& runs() const { return runs_; }

  struct ChannelTotals {
    int64_t messages = 0;  ///< of any run, including damaged ones
    int64_t bytes = 0;
    int64_t rejected = 0;   ///< damaged, malicious or of another version
    std::string rejection;  ///< reason of the last one
  };
  const ChannelTotals& totals(Channel channel) const {
    return totals_[static_cast<size_t>(channel)];
  }
  int64_t others() const { return others_; }
  int64_t rejected() const;

 private:
  RunTally& run_of(const MessageHeader& header);

  RunReader run_;
  std::deque<RunTally> runs_;
  std::array<ChannelTotals, kChannelCount> totals_{};
  int64_t others_ = 0;
};

}  // namespace throng
