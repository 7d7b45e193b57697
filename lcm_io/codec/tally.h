// What came of a run, and what its numbering proves did not.
// One rule: on every channel, messages + missing + before is the highest number heard plus one,
// whatever the order of arrival; a message that comes twice counts once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lcm_io/codec/channels.h"
#include "lcm_io/codec/message_validation.h"

namespace throng {

/// One channel of one run.
struct ChannelTally {
  int64_t messages = 0;
  int64_t bytes = 0;
  int64_t missing = 0;  ///< holes in seq behind `before`
  int64_t before = 0;   ///< sent before the first one heard, where the run's start was not heard
  int64_t next_seq = -1;
  int64_t last_frame = -1;
  int64_t late = 0;        ///< came behind one with a higher number: no longer missing
  int64_t repeated = 0;    ///< came twice
  int64_t incomplete = 0;  ///< sets of chunks that a newer one overtook

  void count(const MessageHeader& header, size_t bytes);
  /// The run was heard from its start: what came before the first message is missing as well.
  void count_from_start();
  /// So many were sent in all.
  void close(int64_t sent);

 private:
  /// Numbers first .. end-1, which are missing.
  struct Hole {
    int64_t first = 0;
    int64_t end = 0;
  };
  bool fill(int64_t seq);
  void open(int64_t first, int64_t end);

  std::vector<Hole> holes_;  // ascending; at most kMaxHoles: older ones stay missing for good
};

/// All channels of one run.
struct RunTally {
  int64_t run_id = 0;
  int64_t instance = 0;
  /// Heard from its first frame or its description's first round: nothing before is excused.
  bool from_start = false;
  bool ended = false;  ///< THRONG_END came: nothing behind the last message is unknown
  std::array<ChannelTally, kChannelCount> channels{};

  ChannelTally& operator[](Channel channel) { return channels[static_cast<size_t>(channel)]; }
  const ChannelTally& operator[](Channel channel) const {
    return channels[static_cast<size_t>(channel)];
  }
  void count(Channel channel, const MessageHeader& header, size_t bytes);
  /// Takes what the run says that it sent.
  void close(const end_t& end);
};

}  // namespace throng
