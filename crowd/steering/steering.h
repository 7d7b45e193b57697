// SteeringModel chooses the next velocity of agents; the models share one interface.
// Invariant: a choice depends on the old state of the agent and of its neighbours, in order. It is
// the same for any split into blocks and any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "base/memory.h"
#include "base/simd.h"
#include "crowd/neighbours/neighbour_grid.h"
#include "crowd/steering/steering_rule.h"

namespace throng {

/// State of an agent that its neighbours read. One cache line, because a reader needs nearly all of
/// it; SIMD code loads groups of four. Positions are relative to the ground's centre.
struct alignas(kCacheLine) NeighbourState {
  float x_m = 0, y_m = 0, vx_mps = 0, vy_mps = 0;
  float preferred_x_mps = 0, preferred_y_mps = 0;
  float direction_x = 0, direction_y = 0;  ///< preferred direction: a unit vector, or zero
  float radius_m = 0;
  float impatience = 0;  ///< 0 to 1: others yield to an agent with more of it
  float catch_up = 0;    ///< 0 to 1: how closely it follows agents that walk off ahead
  float max_speed_mps = 0;
  float horizon_s = 0;                 ///< time without collision
  float ahead_x_m = 0, ahead_y_m = 0;  ///< position after one period at this velocity
};

/// Input of a decision: all agents, also those that do not decide now. Arrays are by slot (see
/// NeighbourGrid) unless stated otherwise.
struct SteeringView {
  const NeighbourState* published = nullptr;
  const uint32_t* neighbours = nullptr;  ///< NeighbourGrid::kMaxNeighbours per slot, nearest first
  const uint8_t* neighbour_counts = nullptr;

  /// Walls near deciding agents, for the i-th at [wall_starts[i], wall_starts[i + 1]). Normals
  /// point from the wall to the agent; clearances are between wall and disc.
  const float* wall_x = nullptr;
  const float* wall_y = nullptr;
  const float* wall_clearance_m = nullptr;
  const uint32_t* wall_starts = nullptr;

  float period_s = 0.1f;  ///< until the next decision
  float wall_horizon_s = 0.5f;
};

/// What a model requires of the crowd before and after its decisions.
struct SteeringTraits {
  /// The model keeps a time gap behind agents of the same direction; otherwise the crowd limits
  /// preferred velocities to one.
  bool has_time_gap = false;
  /// The model smooths velocities; otherwise the crowd smooths preferred ones. Smoothing both makes
  /// agents oscillate about their path.
  bool smooths_velocity = false;
  /// Stuck agents try random sidesteps and publish their preferred velocity instead of the actual
  /// one; otherwise the model resolves such situations.
  bool uses_random_sidesteps = true;
  /// Each agent keeps a constant lateral offset from the shortest path, limited by wall clearance.
  bool uses_lateral_offset = false;
  /// Share of the radii within which discs are pushed apart: 1 keeps whole discs clear.
  float core_radius_scale = 1;
};

class SteeringModel {
 public:
  virtual ~SteeringModel() = default;
  /// Writes the velocities of some slots, by slot. Walls are hard: no velocity leads closer to one
  /// than its clearance allows within the wall horizon. Allocates nothing; thread-safe.
  virtual void decide(const SteeringView& people, std::span<const uint32_t> slots,
                      float* next_x_mps, float* next_y_mps) const = 0;
  virtual SteeringTraits traits() const = 0;
};

std::unique_ptr<const SteeringModel> make_steering_model(SteeringKind kind, SimdTarget target);

/// Maximum number of walls per agent; beyond that the farthest are dropped.
inline constexpr size_t kMaxWalls = 24;

}  // namespace throng
