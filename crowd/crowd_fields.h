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
enum class Saved : uint8_t {
  kElsewhere,  ///< from what is known by person
  kPlainly,
  kAsSpeed,      ///< refused if nobody is that fast
  kAsLook,       ///< refused if no head turns that far
  kAsLookSpeed,  ///< refused if no head turns that fast
  kAsTurn,       ///< refused if nobody turns that fast
  kAsShare,      ///< refused if it is not above 0 and at most 1
  kAsPart,       ///< refused if it is not from 0 to 1
  kAsPace,       ///< of an axis: refused if nobody is that fast
};

// FIELD(type, name, saved), in the order of checkpoints: a new order needs a new
// kCheckpointVersion. First what each step needs, then what decisions do.
//   old_mps       the velocity goes from this ...
//   next_mps      ... to this within the period of a decision
//   drift_mps     what disc relaxation adds
//   smooth_mps    the velocity that the heading follows
//   turn_radps    of the heading, to the left; 0: whoever stands does not turn
//   look_to_rad   where the head turns
//   look_radps    how fast it does
//   squeeze       of the disc's radius: what is left of it where bodies stand closer than discs do
//   held          1: stands before a closed door, or behind somebody who does
//   facing        what somebody who stands turns to: a unit vector, or zero
//   own_side_m    how far to the left of the shortest way somebody walks
//   queued_steps  since the anchor
//   intent_mps    the wanted velocity, smoothed
//   anchor_m      where progress was last made, and the step of it
#define THRONG_WALKER_FIELDS(FIELD)                \
  FIELD(Eigen::Vector2d, position_m, kElsewhere)   \
  FIELD(Eigen::Vector2d, velocity_mps, kElsewhere) \
  FIELD(Eigen::Vector2d, old_mps, kAsSpeed)        \
  FIELD(Eigen::Vector2d, next_mps, kAsSpeed)       \
  FIELD(Eigen::Vector2d, drift_mps, kAsSpeed)      \
  FIELD(Eigen::Vector2d, smooth_mps, kAsSpeed)     \
  FIELD(Eigen::Vector2d, heading, kElsewhere)      \
  FIELD(double, turn_radps, kAsTurn)               \
  FIELD(double, clearance_m, kPlainly)             \
  FIELD(double, free_speed_mps, kElsewhere)        \
  FIELD(double, radius_m, kElsewhere)              \
  FIELD(float, look_to_rad, kAsLook)               \
  FIELD(float, look_radps, kAsLookSpeed)           \
  FIELD(float, squeeze, kAsShare)                  \
  FIELD(uint8_t, held, kPlainly)                   \
  FIELD(Eigen::Vector2d, facing, kAsSpeed)         \
  FIELD(double, own_side_m, kPlainly)              \
  FIELD(int64_t, queued_steps, kPlainly)           \
  FIELD(Eigen::Vector2d, intent_mps, kAsSpeed)     \
  FIELD(Eigen::Vector2d, anchor_m, kPlainly)       \
  FIELD(int64_t, anchor_step, kPlainly)

// FIELD(name, saved): what others see of somebody's latest decision (see Seen); the rest of it
// follows from the walker.
#define THRONG_SHOWN_FIELDS(FIELD) \
  FIELD(wanted_x_mps, kAsPace)     \
  FIELD(wanted_y_mps, kAsPace)     \
  FIELD(way_x, kAsPace)            \
  FIELD(way_y, kAsPace)            \
  FIELD(urge, kAsPart)             \
  FIELD(eagerness, kAsPart)

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
  FIELD(uint8_t, next_held)           \
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
#define THRONG_MEMBER(type, name, saved) type name = zero_of<type>();
  THRONG_WALKER_FIELDS(THRONG_MEMBER)
#undef THRONG_MEMBER
};

/// By slot.
struct AgentStates {
  std::vector<AgentState> all;
  std::vector<Seen> seen;
  /// 1: held up by others ahead who go the same way. Apart, as it is counted at every step.
  std::vector<uint8_t> queuing;
  std::vector<uint8_t> held_up;  ///< a HeldUp

  /// Asks for what lies before `until` in an AgentState, and for what others see of them.
  THRONG_PREFETCH void prefetch(size_t slot, size_t until) const {
    const auto* walker = reinterpret_cast<const std::byte*>(&all[slot]);
    for (size_t at = 0; at < until; at += kCacheLine) __builtin_prefetch(walker + at, 1);
    __builtin_prefetch(&seen[slot], 1);
  }

  const AgentState& operator[](size_t slot) const { return all[slot]; }
  AgentState& operator[](size_t slot) { return all[slot]; }

  /// Calls visit(values, field, saved) for each field.
  template <typename Visit>
  void for_each_field(const Visit& visit) {
#define THRONG_VISIT(type, name, saved) visit(all, &AgentState::name, Saved::saved);
    THRONG_WALKER_FIELDS(THRONG_VISIT)
#undef THRONG_VISIT
#define THRONG_VISIT(name, saved) visit(seen, &Seen::name, Saved::saved);
    THRONG_SHOWN_FIELDS(THRONG_VISIT)
#undef THRONG_VISIT
  }

  void resize(size_t count) {
    all.assign(count, {});
    seen.assign(count, {});
    queuing.assign(count, 0);
    held_up.assign(count, 0);
  }

  /// The slots from `first` on take over all that is known of who had these slots before.
  void carry(const AgentStates& from, std::span<const uint32_t> from_slots, size_t first) {
    for (size_t i = 0; i < from_slots.size(); ++i) {
      all[first + i] = from.all[from_slots[i]];
      seen[first + i] = from.seen[from_slots[i]];
      queuing[first + i] = from.queuing[from_slots[i]];
      held_up[first + i] = from.held_up[from_slots[i]];
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

  void resize(size_t count, size_t most, size_t blocks) {
#define THRONG_RESIZE(type, name) name.resize(count);
    THRONG_DECISION_FIELDS(THRONG_RESIZE)
#undef THRONG_RESIZE
    neighbours.resize(count * most);
    crowded_counts.resize(blocks);
  }
};

}  // namespace throng
