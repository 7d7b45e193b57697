// What a run hands to its sinks: once at the start, once a frame, once at the end.
// One rule: spans are valid during the call only; a sink never changes what the run computes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "avatars/model/model.h"
#include "culling/culler.h"
#include "culling/strategies/strategy.h"
#include "kinematics/kinematics.h"
#include "scenes/file/scene.h"
#include "scenes/run/stages.h"

namespace throng {

/// Where a run goes on that was stopped or killed.
struct Resumed {
  int64_t frame = 0;  ///< the last one before; the run's first frame is the next
  int64_t utime_us = 0;
  std::vector<PairKey> touching;  ///< at that frame: their begins were reported before
  std::vector<uint8_t> levels;    ///< as in Frame
  uint64_t hash = 0;              ///< of the events up to that frame
};

struct RunInfo {
  const Scene* scene = nullptr;
  uint64_t run_id =
      0;  ///< hashes scene content, seed and the options that change results; nothing else
  uint64_t instance = 0;  ///< random for each run, to tell two runs on one channel apart
  double step_s = 0;
  std::vector<std::shared_ptr<const Model>> models;
  /// Index into models. Bodies of avatars are 0 .. avatars-1, those of obstacles follow.
  std::vector<uint16_t> model_of_avatar;
  std::vector<float> scale_of_avatar;
  std::vector<std::string> groups;        ///< names; a person is called "<group> <id>"
  std::vector<uint16_t> group_of_avatar;  ///< index into groups
  /// One a group: the LCM channel that moves its avatars, "" where the simulation does.
  std::vector<std::string> control_channels;
  CullerOptions culler;  ///< with a deadline pairs have levels, and the hash holds them, too
  Strategy strategy = Strategy::kPipeline;
  bool culling = true;             ///< false: nobody was looked at, and there are no events
  std::optional<Resumed> resumed;  ///< then the first frame is not number 0

  int avatar_count() const { return static_cast<int>(model_of_avatar.size()); }
};

/// What the culler found, and where everybody is. `proximity_pairs` are within the scene's
/// proximity_m, and `closest_parts` the nearest parts of two people within closest_parts_m.
struct Frame : CullingResult {
  int64_t number = 0;
  int64_t utime_us = 0;               ///< simulation time
  std::span<const RootPose> roots;    ///< one an avatar
  std::span<const float> speeds_mps;  ///< one an avatar
  std::span<const float>
      postures;  ///< rows one after another, avatar by avatar (see posture_offsets)
  std::span<const size_t> posture_offsets;  ///< avatar_count + 1 entries into postures
  /// One an avatar, 0 where it is not in the scene at this time; empty: everybody is. An absent one
  /// has no pairs and keeps the last root.
  std::span<const uint8_t> present;
  const FrameTimes* times = nullptr;  ///< of the frame so far; kPublish is the previous frame's
};

struct RunEnd {
  int64_t frames = 0;
  int64_t utime_us = 0;
  std::span<const PairEvent> events;  ///< the ends of what still touched
  uint64_t begins = 0;                ///< over the whole run
  uint64_t ends = 0;                  ///< over the whole run, those above included
  uint64_t hash = 0;                  ///< of all events
  /// Of the whole run, where CullerOptions::by_part asks for it.
  const PartTally* by_part = nullptr;
  uint64_t proximity_hash = 0;  ///< of all near rows
};

/// What a frame costs more to hold, so that it only does for those who need it.
struct SinkNeeds {
  bool postures = false;  ///< Frame::postures, of everybody
};

class Sink {
 public:
  virtual ~Sink() = default;
  /// Asked once, before begin().
  virtual SinkNeeds needs() const { return {}; }
  virtual void begin(const RunInfo& run) = 0;
  virtual void frame(const RunInfo& run, const Frame& frame) = 0;
  virtual void end(const RunInfo& run, const RunEnd& end) = 0;
};

/// Of a frame with postures (SinkNeeds::postures); `out` has room for the parts of the avatar's
/// model.
void part_poses(const RunInfo& run, const Frame& frame, size_t avatar, std::span<PartPose> out);

}  // namespace throng
