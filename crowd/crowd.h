// Crowd moves people: a steering model decides ten times a second, and motion is smooth at every
// step in between.
// Invariant: each pass reads the old state and writes the new, so that the same crowd walks the
// same way for any number of threads.
//
// A period is the time between two decisions of an agent. The step of the period in which it
// decides is fixed by id, so that no step takes much longer than another. State lies by slot, the
// order of cells at the beginning of the period (see NeighbourGrid), and is carried along to a new
// one: agents near each other in space are near in memory.
//
// A decision: Progress sees who is stuck, PreferredVelocity where each wants to go, Turning what it
// faces; Avoidance chooses velocities, OverlapRelaxation keeps discs apart. They know
// SteeringState, not each other.
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
  /// Keeps references to `map`, whose doors it opens and closes, and `workers`.
  Crowd(NavigationMap& map, std::span<const AgentSpec> people, const CrowdOptions& options,
        Workers& workers);

  /// Advances by step_s. Allocates nothing.
  void step();
  /// Puts somebody where something outside wants them, after the step that steering took; others
  /// keep clear of the disc as of any other, reckoning with its velocity.
  void override_motion(uint32_t id, const Eigen::Vector2d& position_m,
                       const Eigen::Vector2d& heading, const Eigen::Vector2d& velocity_mps);

  /// Somebody of AgentSpec::is_external is there, or is not: others see that at their next
  /// decision.
  void set_present(uint32_t id, bool is_there);

  /// Everything that the next step depends on and that the constructor does not know.
  void archive(Archive& a);

  /// One decision of everybody, without moving: what the steps of a period do.
  void decide();

  /// Everybody there may ever be; who is in the scene now says traffic().present().
  size_t size() const { return state_.size(); }
  const Journeys& journeys() const { return journeys_; }
  const Population& population() const { return population_; }
  const Queues& queues() const { return queues_; }
  std::span<const Eigen::Vector2d> positions_m() const { return state_.positions_m; }
  /// Unit vectors: the way the body faces.
  std::span<const Eigen::Vector2d> headings() const { return state_.headings; }
  std::span<const Eigen::Vector2d> velocities_mps() const { return state_.velocities_mps; }
  /// How far each head is turned away from the heading, to the left: towards where its owner wants
  /// to go, which the body follows later. At most Gait::kMaxHeadYaw_rad. Keeps its place in memory.
  std::span<const float> head_yaws_rad() const { return state_.head_yaws_rad; }
  /// The way of the latest step.
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

  // What never changes, by person.
  std::vector<float> enters_mps_;     ///< below 0: as those ahead let it
  std::vector<float> radius_scales_;  ///< at the start, see crowd_fields.h

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

  AgentStates carried_;  ///< the slots before, while people take their new ones
  std::vector<double> block_displacements_m_;  ///< one a block, reduced in order
  SteeringCounters counters_;
};

}  // namespace throng
