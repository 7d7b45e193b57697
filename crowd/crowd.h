// Crowd moves agents (pedestrians and robots): a steering model decides ten times per second, and
// motion is smooth at every step in between.
// Invariant: each pass reads the old state and writes the new one; results do not depend on the
// number of threads.
//
// A period is the time between two decisions of an agent. The id fixes the step of the period in
// which an agent decides, so steps cost about the same. State is stored by slot, the order of grid
// cells at the beginning of the period (see NeighbourGrid), and moves along to each new order.
// Agents near each other in space are therefore near in memory.
//
// Passes of a decision, in order: Progress detects stuck agents, PreferredVelocity and Turning
// compute direction and facing, Avoidance chooses velocities, OverlapRelaxation keeps discs apart.
// The passes share SteeringState and do not know each other.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/memory.h"
#include "base/workers.h"
#include "crowd/avoidance.h"
#include "crowd/crowd_counters.h"
#include "crowd/detours.h"
#include "crowd/door_controller.h"
#include "crowd/exits.h"
#include "crowd/journeys.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/overlap_relaxation.h"
#include "crowd/population.h"
#include "crowd/preferred_velocity.h"
#include "crowd/progress.h"
#include "crowd/queues.h"
#include "crowd/social_groups.h"
#include "crowd/spawn.h"
#include "crowd/steering/steering.h"
#include "crowd/steering_state.h"
#include "crowd/triggers.h"
#include "crowd/turning.h"

namespace throng {

struct CrowdOptions {
  uint64_t seed = 1;
  double step_s = 1.0 / 60.0;
  SteeringRule steering;
  SimdTarget simd = SimdTarget::kBest;
};

class Crowd {
 public:
  /// Keeps references to `map`, whose doors it opens and closes, and to `workers`.
  Crowd(NavigationMap& map, std::span<const AgentSpec> people, const CrowdOptions& options,
        Workers& workers);

  /// Advances by step_s. Allocates nothing.
  void step();
  /// Overrides position, heading and velocity of an externally controlled agent after a step.
  /// Others avoid its disc like any other and take its velocity into account.
  void override_motion(uint32_t id, const Eigen::Vector2d& position_m,
                       const Eigen::Vector2d& heading, const Eigen::Vector2d& velocity_mps);

  /// Sets whether an externally controlled agent (AgentSpec::is_external) is in the scene. Others
  /// react from their next decision on.
  void set_present(uint32_t id, bool is_there);

  /// Saves or restores all state that the next step depends on and the constructor does not set.
  void archive(Archive& a);

  /// Runs one decision of all agents without moving them, as the steps of one period do.
  void decide();

  /// Maximum number of agents; population() counts those that are in the scene now.
  size_t size() const { return state_.size(); }
  const Journeys& journeys() const { return journeys_; }
  const Population& population() const { return population_; }
  const Queues& queues() const { return queues_; }
  std::span<const Eigen::Vector2d> positions_m() const { return state_.positions_m; }
  /// Unit vectors: where the bodies face.
  std::span<const Eigen::Vector2d> headings() const { return state_.headings; }
  std::span<const Eigen::Vector2d> velocities_mps() const { return state_.velocities_mps; }
  /// Angle of each head to the heading (rad, positive to the left), at most Gait::kMaxHeadYaw_rad.
  /// It leads towards the preferred direction, and the body follows later. The span stays valid.
  std::span<const float> head_yaws_rad() const { return state_.head_yaws_rad; }
  /// Displacements in the latest step.
  std::span<const double> displacements_m() const { return state_.displacements_m; }
  const SteeringCounters& counters() const { return counters_; }

 private:
  using Slots = SteeringState::Slots;

  void begin_period();
  void update_population();
  void rebuild_slots();
  void assign_slots();
  void start_walking(size_t slot);
  double entering_mps(size_t slot);
  void decide(int phase);
  void update_detours();
  void find_neighbours(Slots slots);
  double update_preferred_velocities(Slots slots);
  double move(size_t slot);

  NavigationMap& map_;
  CrowdOptions options_;
  std::unique_ptr<const SteeringModel> model_;
  SteeringState state_;

  // Constant properties, by id.
  std::vector<float> enters_mps_;     ///< below 0: as agents ahead allow
  std::vector<float> radius_scales_;  ///< initial values, see crowd_fields.h

  Detours detours_;
  Journeys journeys_;
  Population population_;
  Triggers triggers_;
  DoorController door_controller_;
  Exits exits_;
  SocialGroups social_groups_;
  Queues queues_;

  Progress progress_;
  PreferredVelocity preferred_;
  Avoidance avoidance_;
  OverlapRelaxation relaxation_;
  Turning turning_;

  AgentStates carried_;                        ///< previous slots while agents take new ones
  std::vector<double> block_displacements_m_;  ///< one per block, reduced in order
  SteeringCounters counters_;
};

}  // namespace throng
