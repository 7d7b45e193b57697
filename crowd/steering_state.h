// SteeringState contains the data that the behaviours of a crowd share: agents, the state their
// neighbours see, and results of the decision in progress.
// Invariant: blocks depend on the number of agents only, never on the number of threads.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/counting_sort.h"
#include "base/files/archive.h"
#include "base/memory.h"
#include "base/rectangle.h"
#include "base/simd.h"
#include "base/workers.h"
#include "crowd/crowd_fields.h"
#include "crowd/crowd_tuning.h"
#include "crowd/neighbours/neighbour_grid.h"
#include "crowd/spawn.h"
#include "crowd/steering/steering.h"

namespace throng {

/// A decision takes about half a microsecond per agent and a step a tenth of it: a block of a step
/// takes about ten microseconds.
inline constexpr size_t kAgentsPerBlock = 256;

inline int block_count(size_t people) {
  return static_cast<int>((people + kAgentsPerBlock - 1) / kAgentsPerBlock);
}

/// Calls body(begin, end, worker) for the blocks of `people` agents.
template <typename Body>
void for_blocks_of(Workers& workers, size_t people, const Body& body) {
  workers.for_blocks(block_count(people), [&](int block, int worker) {
    const size_t begin = static_cast<size_t>(block) * kAgentsPerBlock;
    body(begin, std::min(begin + kAgentsPerBlock, people), worker);
  });
}

/// Crowd changes it between passes; a behaviour writes only the slots that it is called for.
struct SteeringState {
  using Slots = std::span<const uint32_t>;
  static constexpr size_t kMaxNeighbours = NeighbourGrid::kMaxNeighbours;
  /// Slot of an agent that is outside or gone.
  static constexpr uint32_t kNowhere = UINT32_MAX;

  /// Keeps a reference to `workers_of_run`.
  SteeringState(const Rectangle& ground, std::span<const AgentSpec> people, double seconds_per_step,
                const SteeringTraits& model_traits, SimdTarget simd, Workers& workers_of_run);

  /// Maximum number of agents.
  size_t size() const { return positions_m.size(); }
  uint32_t id(size_t slot) const { return grid.order()[slot]; }
  double now_s() const { return step_s * static_cast<double>(steps); }
  /// Time since an agent last made progress.
  double stalled_s(size_t slot) const {
    return step_s * static_cast<double>(steps - agents[slot].anchor_step);
  }
  uint64_t periods() const { return static_cast<uint64_t>(steps / steps_per_period); }

  /// Slots of the agents that decide now, neighbours in space together.
  Slots deciders() const {
    return {decider_slots.data() + first_deciders[phase],
            decider_slots.data() + first_deciders[phase + 1]};
  }
  /// A later agent to prefetch: slots are too irregular for hardware prefetching.
  static uint32_t later_decider(Slots slots, size_t i) {
    constexpr size_t kAhead = 8;
    return slots[std::min(i + kAhead, slots.size() - 1)];
  }
  Slots neighbours(size_t slot) const {
    return {decisions.neighbours.data() + kMaxNeighbours * slot, decisions.neighbour_counts[slot]};
  }
  THRONG_PREFETCH void prefetch_neighbours(uint32_t slot) const {
    const uint32_t* near = decisions.neighbours.data() + kMaxNeighbours * slot;
    for (size_t k = 0; k < decisions.neighbour_counts[slot]; ++k)
      __builtin_prefetch(&agents.published[near[k]]);
  }
  /// Prefetches the arrays by id that a step writes.
  THRONG_PREFETCH void prefetch_agent(uint32_t id) const {
    __builtin_prefetch(&positions_m[id], 1);
    __builtin_prefetch(&velocities_mps[id], 1);
    __builtin_prefetch(&headings[id], 1);
    __builtin_prefetch(&head_yaws_rad[id], 1);
    __builtin_prefetch(&displacements_m[id], 1);
  }

  /// Calls body(begin, end, worker) for all slots, neighbours in space together.
  template <typename Body>
  void for_slots(const Body& body) const {
    for_blocks_of(workers, grid.order().size(), body);
  }
  /// Calls body(block of slots, block, worker) for the deciding agents.
  template <typename Body>
  void for_deciders(const Body& body) const {
    const Slots all = deciders();
    for_blocks_of(workers, all.size(), [&](size_t begin, size_t end, int worker) {
      body(all.subspan(begin, end - begin), begin / kAgentsPerBlock, worker);
    });
  }
  /// Returns the maximum of body(block of deciders, block), at least 0.
  template <typename Body>
  double max_over_blocks(const Body& body) {
    for_deciders([&](Slots slots, size_t block, int) { block_values[block] = body(slots, block); });
    double value = 0;
    for (int block = 0; block < block_count(deciders().size()); ++block)
      value = std::max(value, block_values[static_cast<size_t>(block)]);
    return value;
  }

  /// Returns whether an agent has no preferred direction.
  bool stands(size_t slot) const {
    return agents.published[slot].direction_x == 0 && agents.published[slot].direction_y == 0;
  }
  /// Sets the preferred velocity of an agent and the direction that others see.
  void set_preferred(size_t slot, const Eigen::Vector2f& preferred_mps);
  /// Updates the state that neighbours see.
  void publish_state(size_t slot) {
    const AgentState& w = agents[slot];
    NeighbourState& published = agents.published[slot];
    Eigen::Vector2f velocity = w.velocity_mps.cast<float>();
    // Stuck agents show their preferred velocity: others can then make room.
    if (traits.uses_random_sidesteps)
      velocity +=
          static_cast<float>(tuning::kPublishedPreferredShare) * published.impatience *
          (Eigen::Vector2f(published.preferred_x_mps, published.preferred_y_mps) - velocity);
    published.vx_mps = velocity.x();
    published.vy_mps = velocity.y();
    published.radius_m = static_cast<float>(w.radius_m) * w.radius_scale;
    published.x_m = grid.x()[slot];
    published.y_m = grid.y()[slot];
    predict_position(slot);
  }
  /// Updates the predicted position after one period.
  void predict_position(size_t slot) {
    const AgentState& w = agents[slot];
    NeighbourState& published = agents.published[slot];
    const auto ahead_s = static_cast<float>(period_s);
    const Eigen::Vector2f velocity = (w.velocity_mps + w.drift_mps).cast<float>();
    published.ahead_x_m = published.x_m + ahead_s * velocity.x();
    published.ahead_y_m = published.y_m + ahead_s * velocity.y();
  }

  /// Lists by phase the slots that decide in it: phase_of(id) modulo the number of phases.
  template <typename PhaseOf>
  void list_deciders(const PhaseOf& phase_of);

  /// Saves or restores data by slot, after the grid, and derives data by id. Checks ranges.
  void archive_agents(Archive& a);

  Workers& workers;
  const SteeringTraits traits;
  const double step_s;
  int steps_per_period = 6;
  double period_s = 0.1;  ///< between two decisions of an agent
  int64_t steps = 0;
  size_t phase = 0;  ///< step of the period, which selects the deciding agents

  // Constant properties, by id.
  std::vector<double> radii_m;
  std::vector<double> desired_speeds_mps;
  float max_radius_m = 0;            ///< maximum over all agents
  double max_desired_speed_mps = 0;  ///< maximum over all agents

  // State read outside the crowd, by id.
  std::vector<Eigen::Vector2d> positions_m;
  std::vector<Eigen::Vector2d> velocities_mps;
  std::vector<Eigen::Vector2d> headings;
  std::vector<float> head_yaws_rad;
  std::vector<double> displacements_m;  ///< displacement in the latest step

  NeighbourGrid grid;
  std::vector<uint32_t> slot_of;         ///< per id, or kNowhere
  std::vector<uint32_t> decider_slots;   ///< phase by phase
  std::vector<uint32_t> first_deciders;  ///< per phase, and the end
  AgentStates agents;
  Decisions decisions;
  std::vector<double> block_values;  ///< one per block, reduced in order
};

/// Counting sort: each phase in the order of slots.
template <typename PhaseOf>
void SteeringState::list_deciders(const PhaseOf& phase_of) {
  const std::span<const uint32_t> ids = grid.order();
  const auto phases = static_cast<uint32_t>(steps_per_period);
  for (size_t slot = 0; slot < ids.size(); ++slot)
    decisions.phase[slot] = static_cast<uint8_t>(phase_of(ids[slot]) % phases);
  counting_sort(
      ids.size(), phases, first_deciders.data(),
      [this](size_t slot) { return decisions.phase[slot]; },
      [this](size_t slot, uint32_t place) { decider_slots[place] = static_cast<uint32_t>(slot); });
}

}  // namespace throng
