// Sink receives a run: its start, each frame, its end.
// Invariant: spans are valid during the call only; a sink never changes the run's results.
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

/// Point at which a stopped run continues.
struct Resumed {
  int64_t frame = 0;  ///< last frame before; the run's first frame is the next
  int64_t utime_us = 0;
  /// Pairs that touch at that frame; their begin events were reported before.
  std::vector<PairKey> touching;
  std::vector<uint8_t> levels;  ///< see Frame
  uint64_t hash = 0;            ///< hash of the events up to that frame
};

struct CrowdChange;  // scenes/run/crowd_change.h

struct RunInfo {
  const Scene* scene = nullptr;
  uint64_t run_id = 0;    ///< hash of scene content, seed and options that change results
  uint64_t instance = 0;  ///< random per run, distinguishes two runs on one channel
  double step_s = 0;
  std::vector<std::shared_ptr<const Model>> models;
  /// Index into models, per avatar. Ids 0 .. avatar_count-1 are avatars; obstacles follow.
  std::vector<uint16_t> model_of_avatar;
  std::vector<float> scale_of_avatar;
  std::vector<std::string> groups;  ///< names; an agent is called "<group> <id>"
  std::vector<uint16_t> group_of_avatar;
  /// LCM channel that controls a group's avatars, per group; "" if the simulation moves them.
  std::vector<std::string> control_channels;
  CullerOptions culler;  ///< budgets give pairs levels, which the hash includes
  Strategy strategy = Strategy::kPipeline;
  bool culling = true;             ///< false: no contact detection, hence no events
  std::optional<Resumed> resumed;  ///< set if the first frame is not number 0

  int avatar_count() const { return static_cast<int>(model_of_avatar.size()); }
};

/// Result of culling, and the state of all avatars. `proximity_pairs` are within the scene's
/// proximity_m, `closest_parts` within its closest_parts_m.
struct Frame : CullingResult {
  int64_t number = 0;
  int64_t utime_us = 0;
  std::span<const RootPose> roots;    ///< per avatar
  std::span<const float> speeds_mps;  ///< per avatar
  std::span<const float> postures;    ///< posture rows, one after another, see posture_offsets
  std::span<const size_t> posture_offsets;  ///< avatar_count + 1 offsets into postures
  /// Per avatar, 0: not in the scene; empty: all are. An absent avatar has no pairs and keeps its
  /// last root.
  std::span<const uint8_t> present;
  /// Changes of the crowd since the previous frame, in order.
  std::span<const CrowdChange> changes;
  const FrameTimes* times = nullptr;  ///< times so far; kPublish is that of the previous frame
};

struct RunEnd {
  int64_t frames = 0;
  int64_t utime_us = 0;
  std::span<const PairEvent> events;
  uint64_t begins = 0;  ///< begin events of the whole run
  uint64_t ends = 0;
  uint64_t hash = 0;
  /// Statistics by pair of parts over the whole run, if CullerOptions::by_part is set.
  const PartTally* by_part = nullptr;
  uint64_t proximity_hash = 0;
};

/// Optional contents of a frame, filled only if a sink needs them.
struct SinkNeeds {
  bool postures = false;  ///< Frame::postures of all avatars
};

class Sink {
 public:
  virtual ~Sink() = default;
  virtual SinkNeeds needs() const { return {}; }
  virtual void begin(const RunInfo& run) = 0;
  virtual void frame(const RunInfo& run, const Frame& frame) = 0;
  virtual void end(const RunInfo& run, const RunEnd& end) = 0;
};

/// Writes the part poses of an avatar, from a frame with postures (SinkNeeds::postures). `out` has
/// one element per part of the avatar's model.
void part_poses(const RunInfo& run, const Frame& frame, size_t avatar, std::span<PartPose> out);

}  // namespace throng
