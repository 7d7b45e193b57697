// RunEncoder turns a run into messages, once for all targets (network, log).
// Invariant: the messages to a target depend on the run and its own options only, not on clocks,
// threads or other targets. After the first frames it allocates only for frames with more events
// than any before.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/workers.h"
#include "lcm_io/codec/channels.h"
#include "lcm_io/codec/description.h"
#include "lcm_io/codec/message_target.h"
#include "scenes/run/sink.h"
#include "scenes/separation/separation_monitor.h"

namespace throng {

class RunEncoder final : public Sink {
 public:
  RunEncoder() = default;
  /// Encodes for one target; keeps a reference to it.
  RunEncoder(const EncoderOptions& options, MessageTarget& target) { add(options, target); }

  RunEncoder(const RunEncoder&) = delete;  // target states keep a reference to it
  RunEncoder& operator=(const RunEncoder&) = delete;

  /// Adds a target before begin(); keeps a reference to it.
  void add(const EncoderOptions& options, MessageTarget& target);

  SinkNeeds needs() const override { return {.postures = true}; }
  /// Encodes the description; each target decides when its chunks are sent. Throws InputError if it
  /// is too large for a reader.
  void begin(const RunInfo& run) override;
  /// Sends the messages of a frame, in order: events, touching, proximity, contact points,
  /// separation, states, part poses, frame statistics, checksums. Touching pairs are sent once per
  /// simulated second, other optional messages if the run has them. A resumed run first sends the
  /// pairs that touched, as touching of the frame before.
  void frame(const RunInfo& run, const Frame& frame) override;
  /// Sends the remaining end events, then THRONG_END.
  void end(const RunInfo& run, const RunEnd& end) override;

  /// Returns the state of target number `i`, in the order of add().
  TargetState& target_state(size_t i = 0) { return *target_states_[i]; }
  const TargetState& target_state(size_t i = 0) const { return *target_states_[i]; }

 private:
  struct AvatarRange {
    int first = 0;
    int count = 0;
    int items = 0;  // joint positions, or parts
  };
  /// A states message and the buffer for its bytes.
  struct StatesSlot {
    states_t message{};
    std::vector<uint8_t> bytes;
    size_t size = 0;
    std::vector<uint64_t> checksums;  // by target, which differ in instance and seq
  };
  using TargetStates = std::vector<TargetState*>;

  friend class TargetState;
  void choose_targets();
  template <class Message>
  void fill_header(Message& message, int chunk, int chunk_count) const;
  template <class Message>
  void send(const TargetStates& to, Channel channel, Message& message, int chunk, int chunk_count);
  template <class Message>
  void send(TargetState& to, Channel channel, Message& message, int chunk, int chunk_count);
  static void set_target_header(const TargetState& to, Channel channel, int64_t ahead,
                                std::span<uint8_t> bytes);
  void deliver(TargetState& to, Channel channel, std::span<const uint8_t> bytes, uint64_t checksum);
  void send_description_chunk(TargetState& to, int chunk);
  template <class Message, class Set>
  void send_rows(Channel channel, Message& m, size_t rows, const Set& set);
  void send_events(std::span<const PairEvent> events);
  void send_touching(std::span<const PairKey> pairs, std::span<const uint8_t> levels);
  void send_proximity(const RunInfo& run, const Frame& frame);
  void send_contacts(std::span<const ContactPoint> points);
  void send_changes(std::span<const CrowdChange> changes);
  void send_separation();
  bool states_are_due(double state_every, int64_t frame) const;
  void send_states(const RunInfo& run, const Frame& frame);
  void fill_states(const RunInfo& run, const Frame& frame, const AvatarRange& range,
                   states_t& m) const;
  void send_part_poses(const RunInfo& run, const Frame& frame);
  void add_part_poses(const Model& model, const RootPose& root, float scale,
                      std::span<const float> posture);
  void send_frame_stats(TargetState& to, const Frame& frame, int64_t begins);
  void send_checksums(TargetState& to, uint64_t hash, bool is_last);
  static void fill_end(const RunEnd& end, const TargetState& of, end_t& m);

  std::vector<std::unique_ptr<TargetState>> target_states_;
  TargetStates open_targets_;  // targets that want messages now
  TargetStates states_targets_,
      part_poses_targets_;  // targets that get these in this frame

  int64_t run_id_ = 0;
  int64_t utime_us_ = 0;
  int64_t frame_ = 0;
  int64_t last_second_ = -1;
  PairLevel last_level_ = PairLevel::kPartVolume;  // level of a pair without one

  std::vector<uint8_t> description_;
  std::vector<std::vector<ColumnRange>> ranges_;
  std::vector<AvatarRange> state_chunks_, part_chunks_;
  std::vector<PartPose> poses_;

  // Reused messages; their vectors keep their capacity.
  std::optional<Workers> workers_;
  std::vector<StatesSlot> states_;
  run_chunk_t run_{};
  events_t events_{};
  touching_t touching_{};
  proximity_t proximity_{};
  contact_points_t contacts_{};
  separation_t separation_{};
  crowd_change_t crowd_change_{};
  std::optional<SeparationMonitor> monitor_;
  frame_stats_t frame_stats_{};
  part_poses_t parts_{};
  checksums_t checks_{};
  std::vector<uint8_t> buffer_ = std::vector<uint8_t>(kMaxMessageBytes);
  uint64_t last_hash_ = 0;
};

/// Throws InputError if a reader would reject the messages of this run. Call it before opening
/// outputs.
void require_encodable(const RunInfo& run, bool part_poses);

/// A target that can also be used alone, as a sink with its own encoder. Targets of one run share
/// an encoder; then this one is not created.
class TargetSink : public Sink, public MessageTarget {
 public:
  virtual EncoderOptions encoding() const = 0;

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override {
    if (!encoder_) encoder_.emplace(encoding(), static_cast<MessageTarget&>(*this));
    encoder_->begin(run);
  }
  void frame(const RunInfo& run, const Frame& frame) override { encoder_->frame(run, frame); }
  void end(const RunInfo& run, const RunEnd& end) override { encoder_->end(run, end); }

  /// Returns what was sent. Valid after begin().
  const TargetState& target_state() const { return encoder_->target_state(); }

 private:
  std::optional<RunEncoder> encoder_;
};

}  // namespace throng
