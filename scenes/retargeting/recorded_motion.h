// RecordedMotion moves recorded people along their tracks, retargeted to walking bodies, and other
// groups, which avoid them.
// Invariant: the tracked point of a body, root or head, follows the record; gait and posture are
// simulated.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scenes/motion/body_blocks.h"
#include "scenes/motion/crowd_motion.h"
#include "scenes/motion/motion_source.h"
#include "scenes/retargeting/head_offset.h"
#include "scenes/retargeting/tracks.h"
#include "scenes/run/body_kinds.h"

namespace throng {

struct WalkInput;

class RecordedMotion : public MotionSource {
 public:
  RecordedMotion(const Scene& scene, SimdTarget simd, Workers& workers);

  const std::vector<std::shared_ptr<const Model>>& models() const override { return kinds_.models; }
  void place(BodyStates& bodies) override;
  void describe(RunInfo& info) const override;
  void prepare(const Posing& posing, const BodyStates& bodies) override;
  void step() override;
  void update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) override;
  void archive(Archive& a) override;
  std::span<const uint8_t> present() const override { return present_; }
  std::span<const uint8_t> expected() const override { return expected_; }
  const std::vector<std::string>& notes() const override { return notes_; }

  // The following are those of the scene's other groups.
  Crowd* crowd() override { return others_ ? others_->crowd() : nullptr; }
  void add_external(ExternalAvatars& external) const override;
  void apply_external(const ExternalAvatars& external) override;
  int unplaced() const override { return others_ ? others_->unplaced() : 0; }
  const SteeringCounters& steering() const override;
  const PopulationCounters& population() const override;
  std::vector<Stranding> strandings() const override;

 private:
  const Recording& recording() const { return *scene_.recorded->recording; }
  bool tracks_heads() const { return recording().facts().tracked_point == TrackedPoint::kHead; }
  const HeadOffset& head_of(const BodyStates& bodies, uint32_t id) const;
  WalkInput walk_to(const TrackState& now, uint32_t id, const Posing& posing, BodyStates& bodies,
                    float& speed_mps);
  void note_anomalies();
  void find_people();
  void move_recorded(const BodyStates& bodies, std::span<const float> speeds_mps);

  const Scene& scene_;
  Workers& workers_;
  SimdTarget simd_;
  Kinds kinds_;
  uint16_t type_;
  double root_height_m_;  ///< height of their roots above the ground at scale 1, in metres
  std::vector<AgentSpec> people_;
  std::vector<BodyBlock> blocks_;
  std::vector<HeadOffset> head_offsets_;  ///< indexed by gait style; empty for unused styles
  std::unique_ptr<Tracks> tracks_;
  std::unique_ptr<CrowdMotion> others_;
  std::vector<uint8_t> present_, expected_;
  int64_t frame_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace throng
