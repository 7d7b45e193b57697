// What a crowd knows of everybody in it, by slot: each field stands once, here.
// One rule: members, room, being carried to a new order of cells and checkpoints follow from these
// lists, so that a field cannot be forgotten in one of them.
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

/// How a field of a walker comes back from a checkpoint.
enum class FieldCheck : uint8_t {
  kDerived,  ///< from what is known by person
  kUnchecked,
  kSpeed,           ///< refused if nobody is that fast
  kHeadYaw,         ///< refused if no head turns that far
  kHeadYawRate,     ///< refused if no head turns that fast
  kTurnRate,        ///< refused if nobody turns that fast
  kShare,           ///< refused if it is not above 0 and at most 1
  kUnitInterval,    ///< refused if it is not from 0 to 1
  kSpeedComponent,  ///< of an axis: refused if nobody is that fast
};

// FIELD(type, name, saved), in the order of checkpoints: a new order needs a new
// kCheckpointVersion. First what each step needs, then what decisions do.
//   old_mps       the velocity goes from this ...
//   next_mps      ... to this within the period of a decision
//   drift_mps     what disc relaxation adds
//   smooth_mps    the velocity that the heading follows
//   turn_radps    of the heading, to the left; 0: whoever stands does not turn
//   target_head_yaw_rad   where the head turns
//   head_yaw_radps    how fast it does
//   squeeze       of the disc's radius: what is left of it where bodies stand closer than discs do
//   held          1: stands before a closed door, or behind somebody who does
//   facing        what somebody who stands turns to: a unit vector, or zero
//   lateral_offset_m    how far to the left of the shortest way somebody walks
//   queued_steps  since the anchor
//   smoothed_preferred_mps    the wanted velocity, smoothed
//   anchor_m      where progress was last made, and the step of it
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

// FIELD(name, saved): what others see of somebody's latest decision (see NeighbourState); the rest
// of it follows from the walker.
#define THRONG_PUBLISHED_FIELDS(FIELD)    \
  FIELD(preferred_x_mps, kSpeedComponent) \
  FIELD(preferred_y_mps, kSpeedComponent) \
  FIELD(direction_x, kSpeedComponent)     \
  FIELD(direction_y, kSpeedComponent)     \
  FIELD(impatience, kUnitInterval)        \
  FIELD(catch_up, kUnitInterval)

// FIELD(type, name), one value a slot: what follows from a walker, and what a decision works out.
//   phase            the step of a period in which somebody decides
//   next_held        what `held` of a walker becomes
//   close_counts     of the neighbours, who may overlap; they come first
//   crowded          of a block, from its first place on: slots with some
//   chosen_x_m...    where those who decide mean to be after a period, from the ground's middle
//   expected_x_m...  the same as far as discs have been pushed apart
//   swept_x_m...     what a sweep makes of it
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

/// Zero of a number or of a vector.
template <typename Value>
Value zero_of() {
  if constexpr (std::is_arithmetic_v<Value>)
    return Value{};
  else
    return Value::Zero();
}

/// Who moves. A step reads and writes nearly all of it, a decision that of one in so many slots:
/// each in a few lines of the cache of their own.
struct alignas(kCacheLine) AgentState {
#define THRONG_MEMBER(type, name, check) type name = zero_of<type>();
  THRONG_AGENT_FIELDS(THRONG_MEMBER)
#undef THRONG_MEMBER
};

/// By slot.
struct AgentStates {
  std::vector<AgentState> all;
  std::vector<NeighbourState> published;
  /// 1: held up by others ahead who go the same way. Apart, as it is counted at every step.
  std::vector<uint8_t> queuing;
  std::vector<uint8_t> stall_cause;  ///< a StallCause

  /// Asks for what lies before `until` in an AgentState, and for what others see of them.
  THRONG_PREFETCH void prefetch(size_t slot, size_t until) const {
    const auto* agent = reinterpret_cast<const std::byte*>(&all[slot]);
    for (size_t at = 0; at < until; at += kCacheLine) __builtin_prefetch(agent + at, 1);
    __builtin_prefetch(&published[slot], 1);
  }

  const AgentState& operator[](size_t slot) const { return all[slot]; }
  AgentState& operator[](size_t slot) { return all[slot]; }

  /// Calls visit(values, field, saved) for each field.
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

  /// The slots from `first` on take over all that is known of who had these slots before.
  void carry(const AgentStates& from, std::span<const uint32_t> from_slots, size_t first) {
    for (size_t i = 0; i < from_slots.size(); ++i) {
      all[first + i] = from.all[from_slots[i]];
      published[first + i] = from.published[from_slots[i]];
      queuing[first + i] = from.queuing[from_slots[i]];
      stall_cause[first + i] = from.stall_cause[from_slots[i]];
    }
  }
};

/// What a decision works out, by slot.
struct Decisions {
#define THRONG_MEMBER(type, name) std::vector<type> name;
  THRONG_DECISION_FIELDS(THRONG_MEMBER)
#undef THRONG_MEMBER
  std::vector<uint32_t> neighbours;      ///< `most` a slot
  std::vector<uint32_t> crowded_counts;  ///< by block

  void resize(size_t count, size_t max_radps, size_t blocks) {
#define THRONG_RESIZE(type, name) name.resize(count);
    THRONG_DECISION_FIELDS(THRONG_RESIZE)
#undef THRONG_RESIZE
    neighbours.resize(count * max_radps);
    crowded_counts.resize(blocks);
  }
};

}  // namespace throng
