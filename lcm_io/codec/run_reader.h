// Puts a run together again from its messages, whether they come from a log or over LCM.
// One rule: takes any bytes in any order; what is refused or missing is counted, never fatal.
// It follows one run: another takes over when this one has ended, when the other begins, or after
// forget(); until then its messages are counted as foreign.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lcm_io/codec/description.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/rows.h"
#include "lcm_io/codec/tally.h"
#include "scenes/run/sink.h"

namespace throng {

/// The crowd at one frame, from THRONG_STATES, in real numbers.
struct CrowdState {
  int64_t frame = -1;
  int64_t utime_us = 0;
  std::vector<RootPose> roots;
  std::vector<float> speeds_mps;
  std::vector<float> postures;   ///< rows one after another (see RunReader::posture_offsets)
  std::vector<uint8_t> present;  ///< one an avatar; 0: not in the scene at this time
};

class RunReader {
 public:
  /// What a message completed or changed.
  enum class Update {
    kNothing,        ///< a piece of something, or a channel that is not ours
    kRun,            ///< run() is new: another run, or the first
    kState,          ///< state() is a newer frame
    kEvents,         ///< touching() and new_events() changed
    kTouching,       ///< touching() was set anew
    kFrameStats,     ///< frame_stats() is new, and the frame is over
    kEnd,            ///< end() is known
    kChecksums,      ///< checks() is new
    kProximity,      ///< proximity_pairs() and closest_parts() are new
    kSeparation,     ///< new_shortfalls() changed
    kContactPoints,  ///< contact_points() is new
    kMessage,        ///< a message that changes none of these
    kRefused         ///< damaged, hostile or of another version: see refusal()
  };

  Update take(std::string_view channel, std::span<const uint8_t> bytes);

  /// Lets whichever run is heard next take over; if it is the same, that goes on (a receiver calls
  /// it after some seconds of silence).
  void forget() { is_free_ = true; }

  /// Forgets how far the run is, not which: the next messages may be older than those before. A
  /// player jumps this way; what the numbering proves missing starts anew.
  void rewind();

  /// Null until the description is complete. States that came before are dropped, not kept.
  const run_description_t* run() const { return run_.get(); }
  int64_t run_id() const { return tally_.run_id; }
  int64_t instance() const { return tally_.instance; }
  /// A model of run(), ready to be posed; built when first asked for. Throws InputError if the
  /// kinematics refuse it.
  std::shared_ptr<const Model> model(size_t index);
  /// avatar_count + 1 entries into CrowdState::postures.
  const std::vector<size_t>& posture_offsets() const { return posture_offsets_; }

  const CrowdState& state() const { return state_; }
  /// Poses of the parts of one avatar in state(); translations relative to its root's position.
  void part_poses(int avatar, std::vector<PartPose>& out);

  /// What touches, and how far each pair was refined when it began.
  using Touching = std::map<PairKey, PairLevel>;
  const Touching& touching() const { return touching_; }
  /// Of the last THRONG_EVENTS message.
  std::span<const PairEvent> new_events() const { return new_events_; }
  /// How near parts are, of the newest frame that said so; of a run that was asked for distances.
  std::span<const ProximityPair> proximity_pairs() const { return proximity_pairs_; }
  std::span<const ProximityPair> closest_parts() const { return near_people_; }
  /// Where parts touch, of the newest frame that said so; of a run that was asked for it.
  std::span<const ContactPoint> contact_points() const { return contact_points_; }
  /// Begins and ends of the last THRONG_SEPARATION message.
  std::span<const ShortfallEvent> new_shortfalls() const { return new_shortfalls_; }
  const std::optional<frame_stats_t>& frame_stats() const { return frame_stats_; }
  const std::optional<end_t>& end() const { return end_; }
  /// What the run says of itself, and of all that it has said so far.
  const std::optional<checksums_t>& checks() const { return checks_; }

  /// What was received of the current run, and what its numbering proves was not.
  const RunTally& tally() const { return tally_; }
  const ChannelTally& tally(Channel channel) const { return tally_[channel]; }
  /// Of the message taken last, whichever run it was of; null if it was damaged or not ours.
  const MessageHeader* header() const { return is_sound_ ? &header_ : nullptr; }
  int64_t foreign() const { return foreign_; }
  int64_t refused() const { return refused_; }
  const std::string& refusal() const { return refusal_; }  ///< the newest

 private:
  /// The chunks that have come of what a frame says chunk by chunk.
  struct ReceivedChunks {
    int64_t frame = -1;
    std::set<int32_t> chunks;
  };
  template <class Message>
  bool starts_anew(Channel channel, const Message& message, ReceivedChunks& received);
  template <class Message>
  static bool completes(const Message& message, ReceivedChunks& received);

  Update refuse(std::string_view channel, std::string why);
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
  bool has_run_ = false;  // tally_ is of a run that was heard
  bool is_free_ = true;
  bool is_sound_ = false;
  MessageHeader header_;
  int64_t refused_ = 0;
  int64_t foreign_ = 0;
  std::string refusal_;

  // The description on its way: pieces by offset.
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
  std::vector<ProximityPair> proximity_pairs_, near_people_, pending_proximity_pairs_,
      pending_closest_parts_;
  std::vector<ContactPoint> contact_points_, pending_contact_points_;
  std::vector<ShortfallEvent> new_shortfalls_;
  std::optional<frame_stats_t> frame_stats_;
  std::optional<end_t> end_;
  std::optional<checksums_t> checks_;
};

}  // namespace throng
