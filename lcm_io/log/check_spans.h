// Compares the messages of a log and their events with the checks that were written into it.
// One rule: what is damaged, missing or too much lies between two checks, and is named by its
// channel; behind such a place the comparison goes on with what the checks say.
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

/// Messages of a channel between two checks that are not what was written.
struct DamagedSpan {
  Channel channel = Channel::kRun;
  int64_t from_frame = -1;  ///< of the checks before; -1: the beginning of the log
  int64_t to_frame = 0;     ///< of the checks behind
  uint64_t from_byte = 0;   ///< of the log
  uint64_t to_byte = 0;
  int64_t written = 0;  ///< messages, by the checks
  int64_t found = 0;

  bool contains(Channel where, uint64_t byte) const {
    return where == channel && byte >= from_byte && byte < to_byte;
  }
};

/// Throng's logs have simulation time as stamps and the sender's numbers. A recorder puts its own
/// numbers and the clock's stamps in their place: then the message's own time counts, and its place
/// between two checks.
bool is_recorders_stamp(const MessageHeader& header, const LogEvent& event);

/// Hashes the events of a log under both kinds at once: which one is meant, the checks say behind
/// them.
class LogHash {
 public:
  static bool is_known(int32_t kind) {
    return kind == static_cast<int32_t>(EventHashKind::kEvents) ||
           kind == static_cast<int32_t>(EventHashKind::kEventsAndLevels);
  }
  /// Adds events in the order of the log; those of a frame may come in pieces.
  void add(int64_t frame, std::span<const PairEvent> events);
  /// Continues from another hash, unless frames have been chained already.
  void start_from(uint64_t hash);
  /// The hash of all events so far.
  uint64_t value(EventHashKind kind);
  /// Replaces the hash so far: what went wrong before is known and reported.
  void resume_from(EventHashKind kind, uint64_t hash);

 private:
  struct KindHash {
    EventSum frame;  // of frame_
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
  /// Counts a message; `header` is null where it has none that can be read.
  void add(Channel channel, const LogEvent& event, const MessageHeader* header);

  /// What differs from the checks that come next. Before add() of the message that they are.
  std::vector<DamagedSpan> differences(const checksums_t& stated, const LogEvent& event,
                                       const MessageHeader& header) const;
  /// Goes on with what was said.
  void adopt(const checksums_t& stated, const LogEvent& event);
  /// Fills in what was counted in place of what was said.
  void fill(checksums_t& stated, const LogEvent& event, const MessageHeader& header) const;

  /// Whether messages are missing before these checks, so that nothing can be compared: the
  /// recorder began late, or lost some.
  bool is_gap(const checksums_t& stated, const LogEvent& event, const MessageHeader& header) const;

 private:
  RunningChecksums sums_, at_last_;
  int64_t next_number_ = 0;
  int64_t last_frame_ = -1;
  uint64_t last_byte_ = 0;
  /// Whom a recorder heard first: only that run's messages count.
  std::optional<std::pair<int64_t, int64_t>> recorded_;
};

}  // namespace throng
