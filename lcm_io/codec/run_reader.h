// RunReader reconstructs a run from its messages, from a log or over LCM.
// Invariant: it accepts any bytes in any order; rejected and missing messages are counted, never
// fatal.
// It follows one run and counts messages of others as foreign. Another run takes over after the end
// of this one, at its own start, after follow() or after forget().
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lcm_io/codec/description.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/rows.h"
#include "lcm_io/codec/tally.h"
#include "scenes/run/sink.h"

namespace throng {

/// State of the crowd in one frame, from THRONG_STATES.
struct CrowdState {
  int64_t frame = -1;
  int64_t utime_us = 0;
  std::vector<RootPose> roots;
  std::vector<float> speeds_mps;
  std::vector<float> postures;   ///< rows of all avatars in turn (see RunReader::posture_offsets)
  std::vector<uint8_t> present;  ///< one per avatar; 0: not in the scene
};

class RunReader {
 public:
  /// What a message completed or changed.
  enum class Update {
    kNothing,  ///< a chunk of something, or an unknown channel
    kRun,      ///< run() is new: another run, or the first
    kState,    ///< state() is a newer frame
    kEvents,
    kTouching,    ///< touching() was replaced
    kFrameStats,  ///< frame_stats() is new, and the frame is complete
    kEnd,
    kChecksums,
    kProximity,
    kSeparation,
    kContactPoints,
    kMessage,
    kRejected  ///< damaged, malicious or of another version: see rejection()
  };

  Update take(std::string_view channel, std::span<const uint8_t> bytes);

  /// Lets the next run take over; the same run may also continue. A receiver calls this after some
  /// seconds of silence.
  void forget() {
    is_free_ = true;
    chosen_.reset();
  }

  /// Switches to a run with its next message. Until it ends, or until forget(), no other run that
  /// starts takes over.
  void follow(int64_t run_id, int64_t instance) { chosen_ = {run_id, instance}; }

  /// Forgets the progress of the run but not its identity, so that older messages may follow. A
  /// player calls this before a jump. Counts of missing messages start again.
  void rewind();

  /// Null until the description is complete. Earlier states are dropped.
  const run_description_t* run() const { return run_.get(); }
  int64_t run_id() const { return tally_.run_id; }
  int64_t instance() const { return tally_.instance; }
  /// Returns a model of run() for posing, built on first use. Throws InputError if its kinematics
  /// are invalid.
  std::shared_ptr<const Model> model(size_t index);
  /// Returns avatar_count + 1 offsets into CrowdState::postures.
  const std::vector<size_t>& posture_offsets() const { return posture_offsets_; }

  const CrowdState& state() const { return state_; }
  /// Computes the part poses of one avatar in state(); translations are relative to its root
  /// position.
  void part_poses(int avatar, std::vector<PartPose>& out);

  /// Touching pairs, with their refinement level at the begin.
  using Touching = std::map<PairKey, PairLevel>;
  const Touching& touching() const { return touching_; }
  /// Returns the events of the last THRONG_EVENTS message.
  std::span<const PairEvent> new_events() const { return new_events_; }
  /// Returns the proximity rows of the newest frame that had some, for a run with a margin.
  std::span<const ProximityPair> proximity_pairs() const { return proximity_pairs_; }
  std::span<const ProximityPair> closest_parts() const { return closest_parts_; }
  /// Returns the contact points of the newest frame that had some, for a run with contact points.
  std::span<const ContactPoint> contact_points() const { return contact_points_; }
  /// Returns begins and ends of the last THRONG_SEPARATION message.
  std::span<const ShortfallEvent> new_shortfalls() const { return new_shortfalls_; }
  const std::optional<frame_stats_t>& frame_stats() const { return frame_stats_; }
  const std::optional<end_t>& end() const { return end_; }
  /// Returns the last THRONG_CHECKSUMS: description of the run and checksums of all messages so
  /// far.
  const std::optional<checksums_t>& checks() const { return checks_; }

  /// Returns what was received of the current run, and which messages are missing by their numbers.
  const RunTally& tally() const { return tally_; }
  const ChannelTally& tally(Channel channel) const { return tally_[channel]; }
  /// Returns the header of the last message, of any run; null if it was damaged or foreign.
  const MessageHeader* header() const { return is_sound_ ? &header_ : nullptr; }
  int64_t foreign() const { return foreign_; }
  int64_t rejected() const { return rejected_; }
  const std::string& rejection() const { return rejection_; }

 private:
  /// Received chunks of a message set of one frame.
  struct ReceivedChunks {
    int64_t frame = -1;
    std::set<int32_t> chunks;
  };
  template <class Message>
  bool starts_anew(Channel channel, const Message& message, ReceivedChunks& received);
  template <class Message>
  static bool completes(const Message& message, ReceivedChunks& received);

  Update reject(std::string_view channel, std::string why);
  bool follows(Channel channel);
  template <class Message>
  Update take(Channel channel, std::span<const uint8_t> bytes);
  std::string handle(const run_chunk_t& piece, Update& update);
  std::string handle(const states_t& states, Update& update);
  std::string handle(const events_t& events, Update& update);
  std::string handle(const touching_t& touching, Update& update);
  std::string handle(const proximity_t& proximity, Update& update);
  std::string handle(const contact_points_t& points, Update& update);
  std::string handle(const separation_t& separation, Update& update);
  std::string handle(frame_stats_t& stats, Update& update);
  std::string handle(end_t& end, Update& update);
  template <class Message>
  std::string handle(const Message& message, Update& update);
  std::string handle(checksums_t& checks, Update& update);
  std::string adopt_description();

  RunTally tally_;
  bool has_run_ = false;
  bool is_free_ = true;
  std::optional<std::pair<int64_t, int64_t>> chosen_;  // run_id and instance
  bool is_sound_ = false;
  MessageHeader header_;
  int64_t rejected_ = 0;
  int64_t foreign_ = 0;
  std::string rejection_;

  // Description being received: chunks by offset.
  std::map<int32_t, std::vector<uint8_t>> pieces_;
  int32_t total_bytes_ = 0;
  int64_t piece_bytes_ = 0;

  std::unique_ptr<run_description_t> run_;
  std::vector<std::shared_ptr<const Model>> models_;
  std::vector<std::vector<ColumnRange>> ranges_;
  std::vector<size_t> posture_offsets_;

  CrowdState state_, pending_;
  int32_t pending_avatars_ = 0;
  std::vector<bool> pending_chunks_;

  Touching touching_, pending_touching_;
  ReceivedChunks touching_chunks_, proximity_chunks_, contact_chunks_;
  std::vector<PairEvent> new_events_;
  std::vector<ProximityPair> proximity_pairs_, closest_parts_, pending_proximity_pairs_,
      pending_closest_parts_;
  std::vector<ContactPoint> contact_points_, pending_contact_points_;
  std::vector<ShortfallEvent> new_shortfalls_;
  std::optional<frame_stats_t> frame_stats_;
  std::optional<end_t> end_;
  std::optional<checksums_t> checks_;
};

}  // namespace throng
