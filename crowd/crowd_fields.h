// Crowd fields lists the state of agents by slot, each field once.
// Invariant: members, sizes, slot changes and checkpoints follow from these lists; no field can be
// missing in one of them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "base/memory.h"
#include "crowd/steering/steering.h"

namespace throng {

/// Range check of an agent's field when a checkpoint is loaded.
enum class FieldCheck : uint8_t {
  kDerived,  ///< not saved: set from data stored by id
  kUnchecked,
  kSpeed,           ///< rejected above the maximum speed
  kHeadYaw,         ///< rejected beyond the largest head yaw
  kHeadYawRate,     ///< rejected above the highest head yaw rate
  kTurnRate,        ///< rejected above the highest turn rate
  kShare,           ///< rejected outside (0, 1]
  kUnitInterval,    ///< rejected outside [0, 1]
  kSpeedComponent,  ///< component of a vector: rejected above the maximum speed
};

// FIELD(type, name, check), in the order of checkpoints: a new order needs a new
// kCheckpointVersion. Fields that each step needs come first, those of decisions follow.
//  - old_mps: velocity at the latest decision
//  - next_mps: chosen velocity, reached within one period
//  - drift_mps: velocity added by overlap relaxation
//  - smooth_mps: velocity that the heading follows
//  - turn_radps: turn rate to the left; 0 while standing
//  - target_head_yaw_rad: head yaw to reach
//  - radius_scale: current over nominal disc radius; below 1 in dense placements
//  - waits_at_door: 1: stopped by a closed door, directly or behind another waiting agent
//  - facing: unit vector that a standing agent turns to, or zero
//  - lateral_offset_m: constant deviation from the shortest path, to the left
//  - queued_steps: steps in queues since the anchor
//  - smoothed_preferred_mps: preferred velocity, smoothed
//  - anchor_m, anchor_step: place and step of the latest progress
#define THRONG_AGENT_FIELDS(FIELD)                       \
  FIELD(Eigen::Vector2d, position_m, kDerived)           \
  FIELD(Eigen::Vector2d, velocity_mps, kDerived)         \
  FIELD(Eigen::Vector2d, old_mps, kSpeed)                \
  FIELD(Eigen::Vector2d, next_mps, kSpeed)               \
  FIELD(Eigen::Vector2d, drift_mps, kSpeed)              \
  FIELD(Eigen::Vector2d, smooth_mps, kSpeed)             \
  FIELD(Eigen::Vector2d, heading, kDerived)              \
  FIELD(double, turn_radps, kTurnRate)                   \
  FIELD(double, clearance_m, kUnchecked)                 \
  FIELD(double, desired_speed_mps, kDerived)             \
  FIELD(double, radius_m, kDerived)                      \
  FIELD(float, target_head_yaw_rad, kHeadYaw)            \
  FIELD(float, head_yaw_radps, kHeadYawRate)             \
  FIELD(float, radius_scale, kShare)                     \
  FIELD(uint8_t, waits_at_door, kUnchecked)              \
  FIELD(Eigen::Vector2d, facing, kSpeed)                 \
  FIELD(double, lateral_offset_m, kUnchecked)            \
  FIELD(int64_t, queued_steps, kUnchecked)               \
  FIELD(Eigen::Vector2d, smoothed_preferred_mps, kSpeed) \
  FIELD(Eigen::Vector2d, anchor_m, kUnchecked)           \
  FIELD(int64_t, anchor_step, kUnchecked)

// FIELD(name, check): what neighbours see of an agent's latest decision (see NeighbourState). Its
// other fields follow from AgentState.
#define THRONG_PUBLISHED_FIELDS(FIELD)    \
  FIELD(preferred_x_mps, kSpeedComponent) \
  FIELD(preferred_y_mps, kSpeedComponent) \
  FIELD(direction_x, kSpeedComponent)     \
  FIELD(direction_y, kSpeedComponent)     \
  FIELD(impatience, kUnitInterval)        \
  FIELD(catch_up, kUnitInterval)

// FIELD(type, name), one value per slot: intermediate results of a decision.
//  - phase: step of the period in which the agent decides
//  - next_waits_at_door: new value of AgentState::waits_at_door
//  - close_counts: number of neighbours that may overlap; they come first
//  - crowded: slots of a block with such neighbours, from the block's first place on
//  - chosen_x_m...: chosen position after one period, relative to the ground's middle
//  - expected_x_m...: the same after the overlap relaxation so far
//  - swept_x_m...: result of the current sweep
#define THRONG_DECISION_FIELDS(FIELD) \
  FIELD(uint8_t, phase)               \
  FIELD(float, next_x_mps)            \
  FIELD(float, next_y_mps)            \
  FIELD(uint8_t, next_waits_at_door)  \
  FIELD(uint8_t, neighbour_counts)    \
  FIELD(uint8_t, close_counts)        \
  FIELD(uint32_t, crowded)            \
  FIELD(float, chosen_x_m)            \
  FIELD(float, chosen_y_m)            \
  FIELD(float, expected_x_m)          \
  FIELD(float, expected_y_m)          \
  FIELD(float, swept_x_m)             \
  FIELD(float, swept_y_m)             \
  FIELD(uint8_t, touched)             \
  FIELD(uint8_t, swept_touched)

template <typename Value>
Value zero_of() {
  if constexpr (std::is_arithmetic_v<Value>)
    return Value{};
  else
    return Value::Zero();
}

/// State of one agent. A step uses nearly all of it and a decision that of one in several slots, so
/// each agent has its own cache lines.
struct alignas(kCacheLine) AgentState {
#define THRONG_MEMBER(type, name, check) type name = zero_of<type>();
  THRONG_AGENT_FIELDS(THRONG_MEMBER)
#undef THRONG_MEMBER
};

struct AgentStates {
  std::vector<AgentState> all;
  std::vector<NeighbourState> published;
  /// 1: held up by others ahead in the same direction. Separate, because each step counts it.
  std::vector<uint8_t> queuing;
  std::vector<uint8_t> stall_cause;  ///< a StallCause

  /// Prefetches the first `until` bytes of an AgentState, and its NeighbourState.
  THRONG_PREFETCH void prefetch(size_t slot, size_t until) const {
    const auto* agent = reinterpret_cast<const std::byte*>(&all[slot]);
    for (size_t at = 0; at < until; at += kCacheLine) __builtin_prefetch(agent + at, 1);
    __builtin_prefetch(&published[slot], 1);
  }

  const AgentState& operator[](size_t slot) const { return all[slot]; }
  AgentState& operator[](size_t slot) { return all[slot]; }

  /// Calls visit(values, field, check) for each field.
  template <typename Visit>
  void for_each_field(const Visit& visit) {
#define THRONG_VISIT(type, name, check) visit(all, &AgentState::name, FieldCheck::check);
    THRONG_AGENT_FIELDS(THRONG_VISIT)
#undef THRONG_VISIT
#define THRONG_VISIT(name, check) visit(published, &NeighbourState::name, FieldCheck::check);
    THRONG_PUBLISHED_FIELDS(THRONG_VISIT)
#undef THRONG_VISIT
  }

  void resize(size_t count) {
    all.assign(count, {});
    published.assign(count, {});
    queuing.assign(count, 0);
    stall_cause.assign(count, 0);
  }

  /// Copies the state of `from_slots` to the slots from `first` on.
  void carry(const AgentStates& from, std::span<const uint32_t> from_slots, size_t first) {
    for (size_t i = 0; i < from_slots.size(); ++i) {
      all[first + i] = from.all[from_slots[i]];
      published[first + i] = from.published[from_slots[i]];
      queuing[first + i] = from.queuing[from_slots[i]];
      stall_cause[first + i] = from.stall_cause[from_slots[i]];
    }
  }
};

struct Decisions {
#define THRONG_MEMBER(type, name) std::vector<type> name;
  THRONG_DECISION_FIELDS(THRONG_MEMBER)
#undef THRONG_MEMBER
  std::vector<uint32_t> neighbours;      ///< max_neighbours per slot
  std::vector<uint32_t> crowded_counts;  ///< per block

  void resize(size_t count, size_t max_neighbours, size_t blocks) {
#define THRONG_RESIZE(type, name) name.resize(count);
    THRONG_DECISION_FIELDS(THRONG_RESIZE)
#undef THRONG_RESIZE
    neighbours.resize(count * max_neighbours);
    crowded_counts.resize(blocks);
  }
};

}  // namespace throng
