// Where encoded messages go: a log, the wire, a file of the page.
// One rule: a target has its own count of messages and its own checksums, so what it got can be
// judged without the others.
#pragma once

#include <cstdint>
#include <span>

#include "lcm_io/codec/channels.h"
#include "lcm_io/codec/running_checksums.h"
#include "throng/end_t.hpp"

namespace throng {

class TargetState;
class RunEncoder;

struct EncoderOptions {
  bool with_instance = true;     ///< false: instance is 0
  bool with_clock_times = true;  ///< false: everything read from a clock is 0
  /// Frames from states to states, at least 1 and not always whole: those of the first frame, and
  /// of each that is the first at or after a multiple of it. Events are always complete.
  double state_every = 1;
  bool part_poses = false;  ///< THRONG_PART_POSES with every states message
  int threads = 1;          ///< states are encoded by so many; the bytes are the same
};

class MessageTarget {
 public:
  virtual ~MessageTarget() = default;
  /// The bytes hold during the call.
  virtual void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) = 0;
  /// False: it gets nothing for now, and nothing is counted for it.
  virtual bool wants_messages() const { return true; }
  /// What only the target knows when to send: the description, and what comes behind the end.
  virtual void after_begin(TargetState& /*outlet*/) {}
  virtual void after_frame(TargetState& /*outlet*/) {}
  virtual void after_end(TargetState& /*outlet*/) {}
};

/// An encoder's side of one target: its options, and all that was said to it.
class TargetState {
 public:
  TargetState(RunEncoder& encoder, const EncoderOptions& options, MessageTarget& target)
      : encoder_(encoder), options_(options), target_(target) {}

  int description_chunks() const;
  void send_description_chunk(int chunk);
  /// THRONG_END once more, with the totals of the first.
  void repeat_end();
  /// Over all that was said, THRONG_END included: nothing comes behind it.
  void send_last_checksums();

  const RunningChecksums::Sum& totals(Channel channel) const { return sent_[channel]; }
  /// Values that did not fit their message so far (see quantise.h).
  int64_t clamped() const { return clamped_; }

 private:
  friend class RunEncoder;

  RunEncoder& encoder_;
  EncoderOptions options_;
  MessageTarget& target_;
  int64_t instance_ = 0;
  RunningChecksums sent_;
  int64_t clamped_ = 0;
  end_t end_{};
};

}  // namespace throng
