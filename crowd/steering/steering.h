// How people choose their next velocity: models behind one interface.
// One rule: a choice depends on the old state of the person and of those near, in this order, so it
// is the same for any split into blocks and any number of threads.
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

/// What others see of somebody: one line of the cache, as whoever looks at a neighbour reads nearly
/// all of it, in groups of four that fast paths load as one. Places count from the middle of the
/// ground.
struct alignas(kCacheLine) NeighbourState {
  float x_m = 0, y_m = 0, vx_mps = 0, vy_mps = 0;
  float preferred_x_mps = 0, preferred_y_mps = 0;
  float direction_x = 0, direction_y = 0;  ///< where to: a unit vector, or zero
  float radius_m = 0;
  float impatience = 0;  ///< 0 to 1: others make way for who has more of it
  float catch_up = 0;    ///< 0 to 1: how much one hurries after who walks off ahead
  float max_speed_mps = 0;
  float horizon_s = 0;                 ///< no collision for so long
  float ahead_x_m = 0, ahead_y_m = 0;  ///< the place after a period of going on like this
};

/// The people of a decision, those included who do not decide now. Arrays are by slot (see
/// NeighbourGrid) unless they say otherwise.
struct SteeringView {
  const NeighbourState* published = nullptr;
  const uint32_t* neighbours = nullptr;  ///< NeighbourGrid::kMaxNeighbours a slot, nearest first
  const uint8_t* neighbour_counts = nullptr;

  /// Walls near those who decide: normals point from the wall to the person, clearances are what is
  /// left between wall and disc. Those of the i-th are [wall_starts[i], wall_starts[i + 1]).
  const float* wall_x = nullptr;
  const float* wall_y = nullptr;
  const float* wall_clearance_m = nullptr;
  const uint32_t* wall_starts = nullptr;

  float period_s = 0.1f;  ///< until they decide again
  float wall_horizon_s = 0.5f;
};

/// What a crowd does for the people of a model before and after they decide.
struct SteeringTraits {
  /// The model itself keeps a gap in time behind others of the same way; otherwise wishes are
  /// limited to one before it decides.
  bool has_time_gap = false;
  /// The model itself takes up little by little what people want; otherwise wishes change little by
  /// little. Both in a row make people swing round their way.
  bool smooths_velocity = false;
  /// People who are stuck try ways past at random, and show others the velocity that they want
  /// instead of their own; otherwise the model gets them out by itself.
  bool uses_random_sidesteps = true;
  /// People walk on a side of their own of the shortest way, as far as walls leave room.
  bool uses_lateral_offset = false;
  /// Discs that overlap by more than this share of their radii leaves room for are pushed apart: 1
  /// for people who keep all of them clear.
  float core_radius_scale = 1;
};

class SteeringModel {
 public:
  virtual ~SteeringModel() = default;
  /// Writes the velocities of some slots, by slot. No allocation. Walls are
  /// hard: nobody's velocity leads nearer to one than its clearance within the wall's horizon.
  virtual void decide(const SteeringView& people, std::span<const uint32_t> slots,
                      float* next_x_mps, float* next_y_mps) const = 0;
  virtual SteeringTraits traits() const = 0;
};

std::unique_ptr<const SteeringModel> make_steering_model(SteeringKind kind, SimdTarget target);

/// Walls that a person can have at once; beyond, the farthest are left out.
inline constexpr size_t kMaxWalls = 24;

}  // namespace throng
