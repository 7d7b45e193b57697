// CheckSpans compares the messages of a log with the checksums in it.
// Invariant: damaged, missing and extra messages are located between two checksum messages and
// attributed to a channel; behind them the comparison continues with the totals of the sender.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "culling/event_hash.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/running_checksums.h"
#include "lcm_io/log/log_reader.h"

namespace throng {

/// Messages of a channel between two checksum messages that differ from those written.
struct DamagedSpan {
  Channel channel = Channel::kRun;
  int64_t from_frame = -1;  ///< frame of the earlier checksums; -1: start of the log
  int64_t to_frame = 0;     ///< frame of the later checksums
  uint64_t from_byte = 0;   ///< offset in the log
  uint64_t to_byte = 0;
  int64_t written = 0;  ///< number of messages by the checksums
  int64_t found = 0;

  bool contains(Channel where, uint64_t byte) const {
    return where == channel && byte >= from_byte && byte < to_byte;
  }
};

/// Returns whether a recorder stamped this event. Throng's logs have simulation time as stamps and
/// the sender's numbers; a recorder writes its own numbers and clock times instead. Then the time
/// in the message counts, and its position between two checksum messages.
bool is_recorders_stamp(const MessageHeader& header, const LogEvent& event);

/// Hashes the events of a log as both kinds, because the kind is known only at the next checksums.
class LogHash {
 public:
  static bool is_known(int32_t kind) {
    return kind == static_cast<int32_t>(EventHashKind::kEvents) ||
           kind == static_cast<int32_t>(EventHashKind::kEventsAndLevels);
  }
  /// Adds events in the order of the log; those of a frame may come in several calls.
  void add(int64_t frame, std::span<const PairEvent> events);
  /// Continues from another hash, unless frames have been hashed already.
  void start_from(uint64_t hash);
  uint64_t value(EventHashKind kind);
  /// Replaces the hash after a difference that has been reported.
  void resume_from(EventHashKind kind, uint64_t hash);

 private:
  struct KindHash {
    EventSum frame;
    EventHash hash;
  };
  KindHash& kind_hash(EventHashKind kind) {
    return kind_hashes_[kind == EventHashKind::kEventsAndLevels ? 1 : 0];
  }
  void finish_frame();

  std::array<KindHash, 2> kind_hashes_;
  int64_t frame_ = 0;
  bool is_chained_ = false;
};

class CheckSpans {
 public:
  /// Counts a message; `header` is null if it has none that can be read.
  void add(Channel channel, const LogEvent& event, const MessageHeader* header);

  /// Returns the differences from the next checksums. Call before add() of their message.
  std::vector<DamagedSpan> differences(const checksums_t& stated, const LogEvent& event,
                                       const MessageHeader& header) const;
  void adopt(const checksums_t& stated, const LogEvent& event);
  void fill(checksums_t& stated, const LogEvent& event, const MessageHeader& header) const;

  /// Returns whether messages are missing before these checksums, so that a comparison is
  /// impossible: a recorder started late or lost some.
  bool is_gap(const checksums_t& stated, const LogEvent& event, const MessageHeader& header) const;

 private:
  RunningChecksums sums_, at_last_;
  int64_t next_number_ = 0;
  int64_t last_frame_ = -1;
  uint64_t last_byte_ = 0;
  /// The run that a recorder received first; only its messages count.
  std::optional<std::pair<int64_t, int64_t>> recorded_;
};

}  // namespace throng
