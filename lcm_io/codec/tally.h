// ChannelTally and RunTally count the received and the missing messages of a run.
// Invariant: on every channel, messages + missing + before equals the highest number received plus
// one, in any order of arrival; a repeated message counts once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lcm_io/codec/channels.h"
#include "lcm_io/codec/message_validation.h"

namespace throng {

struct ChannelTally {
  int64_t messages = 0;
  int64_t bytes = 0;
  int64_t missing = 0;  ///< gaps in seq after `before`
  int64_t before = 0;   ///< sent before the first one received, if the start of the run was not
                        ///< received
  int64_t next_seq = -1;
  int64_t last_frame = -1;
  int64_t late = 0;  ///< arrived after a higher number; not missing
  int64_t repeated = 0;
  int64_t incomplete = 0;  ///< sets of chunks overtaken by a newer set

  void count(const MessageHeader& header, size_t bytes);
  /// Marks the run as received from its start: messages before the first one are missing as well.
  void count_from_start();
  void close(int64_t sent);

 private:
  /// Missing numbers, first .. end-1.
  struct Hole {
    int64_t first = 0;
    int64_t end = 0;
  };
  bool fill(int64_t seq);
  void open(int64_t first, int64_t end);

  std::vector<Hole> holes_;  // ascending; at most kMaxHoles, older ones count as missing for good
};

struct RunTally {
  int64_t run_id = 0;
  int64_t instance = 0;
  /// The first frame or the first round of the description was received, so earlier messages count.
  bool from_start = false;
  bool ended = false;  ///< THRONG_END was received: all messages are known
  std::array<ChannelTally, kChannelCount> channels{};

  ChannelTally& operator[](Channel channel) { return channels[static_cast<size_t>(channel)]; }
  const ChannelTally& operator[](Channel channel) const {
    return channels[static_cast<size_t>(channel)];
  }
  void count(Channel channel, const MessageHeader& header, size_t bytes);
  void close(const end_t& end);
};

}  // namespace throng
