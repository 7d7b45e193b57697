// MessageTarget receives encoded messages: a log, the network, a file for the page.
// Invariant: each target has its own message counts and checksums and can be checked without the
// others.
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
  bool with_clock_times = true;  ///< false: all clock times are 0
  /// Frames between states messages, at least 1, not necessarily whole. States are sent in the
  /// first frame and in the first frame at or after each multiple. Events are always complete.
  double state_every = 1;
  bool part_poses = false;  ///< send THRONG_PART_POSES with each states message
  int threads = 1;          ///< threads that encode states; the bytes do not depend on it
};

class MessageTarget {
 public:
  virtual ~MessageTarget() = default;
  /// Receives a message; `bytes` is valid during the call.
  virtual void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) = 0;
  /// Returns false to receive no messages for now; they are not counted either.
  virtual bool wants_messages() const { return true; }
  /// Hooks for messages whose time the target decides: the description, and messages after the end.
  virtual void after_begin(TargetState& /*state*/) {}
  virtual void after_frame(TargetState& /*state*/) {}
  virtual void after_end(TargetState& /*state*/) {}
};

/// Encoder's state of one target: its options and the totals sent to it.
class TargetState {
 public:
  TargetState(RunEncoder& encoder, const EncoderOptions& options, MessageTarget& target)
      : encoder_(encoder), options_(options), target_(target) {}

  int description_chunks() const;
  void send_description_chunk(int chunk);
  /// Sends THRONG_END again, with the same totals.
  void repeat_end();
  /// Sends checksums of all messages including THRONG_END, as the last message.
  void send_last_checksums();

  const RunningChecksums::Sum& totals(Channel channel) const { return sent_[channel]; }
  /// Number of values clamped so far (see quantise.h).
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
