// CrowdMotion moves the agents of a scene's groups: steering by Crowd, walking by
// scenes/motion/walk.h.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "crowd/crowd.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"
#include "scenes/motion/body_blocks.h"
#include "scenes/motion/motion_source.h"
#include "scenes/run/body_kinds.h"

namespace throng {

struct WalkInput;

class CrowdMotion final : public MotionSource {
 public:
  /// `external_people`: first agents of the crowd, whose bodies another source places and moves.
  CrowdMotion(const Scene& scene, SimdTarget simd, Workers& workers,
              std::span<const AgentSpec> external_people = {});

  const std::vector<std::shared_ptr<const Model>>& models() const override { return kinds_.models; }
  void place(BodyStates& bodies) override;
  void describe(RunInfo& info) const override;
  void step() override { crowd_.step(); }
  void update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) override;
  void archive(Archive& a) override { crowd_.archive(a); }
  std::span<const uint8_t> present() const override;

  void add_external(ExternalAvatars& external) const override;
  void apply_external(const ExternalAvatars& external) override;

  Crowd* crowd() override { return &crowd_; }

  const std::vector<std::string>& notes() const override { return spawned_.notes; }
  int unplaced() const override;
  const SteeringCounters& steering() const override { return crowd_.counters(); }
  const PopulationCounters& population() const override { return crowd_.population().counters(); }
  std::vector<Stranding> strandings() const override {
    return crowd_.journeys().strandings(crowd_.positions_m());
  }

 private:
  bool is_external(const AgentSpec& person) const {
    return scene_.groups[person.group].is_external();
  }
  void note_external();
  WalkInput move_root(uint32_t id, BodyStates& bodies, float& speed_mps) const;

  const Scene& scene_;
  Workers& workers_;
  SimdTarget simd_;
  Kinds kinds_;
  NavigationMap map_;
  uint32_t external_count_;
  SpawnResult spawned_;
  Crowd crowd_;
  std::vector<double> root_heights_m_;
  std::vector<BodyBlock> blocks_;
};

}  // namespace throng
