// Everything that comes in on our channels, from whichever runs: one of them is followed, all are
// counted. One rule: nothing that is received can stop it or make it grow without end.
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
  /// Runs that are remembered; the one that was silent longest makes room.
  static constexpr size_t kMaxRuns = 32;

  /// Judges, counts and uses a message.
  RunReader::Update take(std::string_view channel, std::span<const uint8_t> bytes);

  /// The run that is followed.
  RunReader& run() { return run_; }
  const RunReader& run() const { return run_; }

  /// Every run heard, told apart by run id and instance; the one heard last comes last.
  const std::deque<RunTally>& runs() const { return runs_; }

  struct ChannelTotals {
    int64_t messages = 0;  ///< of any run, damaged ones included
    int64_t bytes = 0;
    int64_t refused = 0;  ///< damaged, hostile or of another version
    std::string refusal;  ///< why, the newest
  };
  const ChannelTotals& totals(Channel channel) const {
    return totals_[static_cast<size_t>(channel)];
  }
  /// Messages on channels that are not ours.
  int64_t others() const { return others_; }
  int64_t refused() const;

 private:
  RunTally& run_of(const MessageHeader& header);

  RunReader run_;
  std::deque<RunTally> runs_;
  std::array<ChannelTotals, kChannelCount> totals_{};
  int64_t others_ = 0;
};

}  // namespace throng
