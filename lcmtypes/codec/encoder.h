// Turns a run into messages: the same ones for the wire and for the log.
// One rule: what is encoded depends on the run and the options only, never on a clock or a thread;
// after the first frames nothing is allocated unless a frame has more events than any before.
#pragma once

#include <span>
#include <vector>

#include "base/workers.h"
#include "lcmtypes/codec/channels.h"
#include "lcmtypes/codec/description.h"
#include "lcmtypes/log/running_checks.h"
#include "scenes/run/sink.h"
#include "throng/checks_t.hpp"
#include "throng/counters_t.hpp"
#include "throng/end_t.hpp"
#include "throng/events_t.hpp"
#include "throng/parts_t.hpp"
#include "throng/run_t.hpp"
#include "throng/states_t.hpp"
#include "throng/touching_t.hpp"

namespace throng {

struct EncoderOptions {
  bool with_instance = true;     ///< false: instance is 0
  bool with_clock_times = true;  ///< false: everything read from a clock is 0
  /// Frames from states to states, at least 1 and not always whole: those of the first frame, and
  /// of each that is the first at or after a multiple of it. Events are always complete.
  double state_every = 1;
  bool part_poses = false;  ///< THRONG_PARTS with every states message
  int threads = 1;          ///< states are encoded by so many; the bytes are the same
};

/// Where encoded messages go. The bytes hold during the call.
class MessageTarget {
 public:
  virtual ~MessageTarget() = default;
  virtual void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) = 0;
};

class RunEncoder {
 public:
  /// Keeps a reference to `target`.
  RunEncoder(const EncoderOptions& options, MessageTarget& target);

  /// Encodes the description; sends nothing. Throws InputError if it is larger than a reader takes.
  void begin(const RunInfo& run);
  /// Messages in this order: events, touching (once a simulated second), states, parts, counters,
  /// checks.
  /// A run that was resumed first sends what touched before, as touching of the frame before.
  void frame(const RunInfo& run, const Frame& frame);
  /// The last ends, then THRONG_END.
  void end(const RunInfo& run, const RunEnd& end);

  int description_chunks() const;
  void send_description_chunk(int chunk);
  /// THRONG_END once more, with the totals of the first.
  void repeat_end();
  /// Over all that was said, THRONG_END included: nothing comes behind it.
  void send_last_checks();

  const RunningChecks::Sum& totals(Channel channel) const { return said_[channel]; }
  /// Values that did not fit their message so far (see quantise.h).
  int64_t clamped() const { return clamped_; }

 private:
  struct AvatarRange {
    int first = 0;
    int count = 0;
    int items = 0;  // joint values, or parts
  };
  /// A states message with room for its bytes.
  struct StatesSlot {
    states_t message{};
    std::vector<uint8_t> bytes;
    size_t size = 0;
    uint64_t checksum = 0;
  };
  template <class Message>
  void number(Message& message, int64_t seq, int chunk, int chunk_count) const;
  template <class Message>
  void send(Channel channel, Message& message, int chunk, int chunk_count);
  void hand_over(Channel channel, std::span<const uint8_t> bytes, uint64_t checksum);
  void send_events(std::span<const PairEvent> events);
  void send_touching(std::span<const PairKey> pairs, std::span<const uint8_t> levels);
  bool states_are_due(int64_t frame) const;
  void send_states(const RunInfo& run, const Frame& frame);
  void fill_states(const RunInfo& run, const Frame& frame, const AvatarRange& range,
                   states_t& m) const;
  void send_parts(const RunInfo& run, const Frame& frame);
  void add_part_poses(const Model& model, const RootPose& root, float scale,
                      std::span<const float> posture);
  void send_counters(const Frame& frame);
  void send_checks(uint64_t hash);

  EncoderOptions options_;
  MessageTarget& target_;
  RunningChecks said_;
  int64_t clamped_ = 0;

  int64_t run_id_ = 0;
  int64_t instance_ = 0;
  int64_t utime_us_ = 0;
  int64_t frame_ = 0;
  int64_t last_second_ = -1;
  PairLevel last_level_ = PairLevel::kPartVolume;  // what a pair without a level got to

  std::vector<uint8_t> description_;
  std::vector<std::vector<ColumnRange>> ranges_;  // by model
  std::vector<AvatarRange> state_chunks_, part_chunks_;
  std::vector<PartPose> poses_;

  // Some of these and one of each other, reused; their vectors keep their capacity.
  Workers workers_;
  std::vector<StatesSlot> states_;
  run_t run_{};
  events_t events_{};
  touching_t touching_{};
  counters_t counters_{};
  end_t end_{};
  parts_t parts_{};
  checks_t checks_{};
  std::vector<uint8_t> buffer_;
};

/// Throws InputError if what the run is about to send could not be read: what begin() of its
/// encoder would throw, to be known before anything is opened.
void require_readable(const RunInfo& run, bool part_poses);

}  // namespace throng
