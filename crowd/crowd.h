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
#include <limits>
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

/// Place and motion of an agent that Crowd::add() adds.
struct AgentEntry {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  /// Not a number: along its path.
  double heading_rad = std::numeric_limits<double>::quiet_NaN();
  double speed_mps = 0;  ///< along the heading

  void archive(Archive& a) { a(position_m, heading_rad, speed_mps); }
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

  /// Number of agents that add() can still add to a group, and the id of the first.
  uint32_t spares(size_t group) const { return population_.spares(group); }
  uint32_t first_spare(size_t group) const { return population_.first_spare(group); }
  /// Adds the next spare agents of a group, one per entry. They stand or walk straight on until
  /// their first decision, within a period. Returns the first id; the others follow.
  uint32_t add(size_t group, std::span<const AgentEntry> entries);
  /// Returns whether an agent is in the scene and can be changed by the following functions; agents
  /// of another source cannot.
  bool can_change(uint32_t id) const {
    return id < size() && is_own_[id] != 0 && journeys_.is_present(id);
  }
  /// Removes an agent. Others react within a period.
  void remove(uint32_t id);
  /// Sends agents to a goal without a queue, at once; it is the only one from now on. The calling
  /// thread computes its flow field. Throws InputError without effect if there are too many goals.
  void set_goal(std::span<const uint32_t> ids, const Goal& goal);
  void set_desired_speed(uint32_t id, double mps);

  /// Saves or restores all state that the next step depends on and the constructor does not set.
  void archive(Archive& a);

  /// Runs one decision of all agents without moving them, as the steps of one period do.
  void decide();

  /// Maximum number of agents; population() counts those that are in the scene now.
  size_t size() const { return state_.size(); }
  size_t group_of(uint32_t id) const { return map_.group_of(journeys_.route(id)); }
  /// Distance of a point to the nearest wall (m), at most Walkable::kReach_m; not positive in one.
  double clearance_m(const Eigen::Vector2d& point) const {
    return map_.walkable().clearance_m(point);
  }
  double radius_m(uint32_t id) const { return state_.radii_m[id]; }
  double max_radius_m() const { return static_cast<double>(state_.max_radius_m); }
  /// Returns a present agent nearer to a disc at this point than min_apart_m().
  std::optional<uint32_t> find_overlapping(const Eigen::Vector2d& point, double radius_m) const;
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
  Eigen::Vector2d heading_of(uint32_t id, const AgentEntry& entry) const;
  double move_added();
  void archive_added(Archive& a);
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
  std::vector<float> radius_scales_;  ///< initial values, see crowd_fields.h
  std::vector<uint8_t> is_own_;       ///< 0: agents of another source

  std::vector<float> enters_mps_;  ///< per id; below 0: as agents ahead allow
  std::vector<uint32_t> added_;    ///< ids that add() added since the period began

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
