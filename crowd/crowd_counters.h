// Crowd counters report steering effort, population and stranded agents.
// Invariant: plain numbers, all zero without steering; every motion source can report them.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/files/archive.h"

namespace throng {

struct SteeringCounters {
  // Agents that decided in the latest step.
  int sweeps = 0;            ///< sweeps of overlap relaxation
  double max_overlap_m = 0;  ///< largest overlap of two discs
  /// Longest time without a displacement of kStall_m, not counting time in queues.
  double longest_stall_s = 0;
  uint64_t queuing = 0;  ///< agents held up by others ahead in the same direction
  // Totals since the start.
  uint64_t rounds = 0;     ///< steps in which agents decided
  uint64_t decisions = 0;  ///< sum over agents
  uint64_t all_sweeps = 0;
  int max_sweeps = 0;
  double turned_rad = 0;  ///< sum over headings, both directions
  double walked_s = 0;    ///< sum over agents

  double mean_sweeps() const {
    return rounds == 0 ? 0 : static_cast<double>(all_sweeps) / static_cast<double>(rounds);
  }
  double mean_heading_rate_radps() const { return walked_s > 0 ? turned_rad / walked_s : 0; }

  void archive(Archive& a) {
    a(sweeps, max_overlap_m, longest_stall_s, queuing, rounds, decisions, all_sweeps, max_sweeps,
      turned_rad, walked_s);
  }
};

/// entered = present + left; all agents = entered + waiting_to_enter + scheduled + spare ones.
struct PopulationCounters {
  uint64_t entered = 0;  ///< includes agents of the start
  uint64_t present = 0;
  uint64_t left = 0;
  uint64_t waiting_to_enter = 0;  ///< due, but without room to enter
  uint64_t scheduled = 0;         ///< not yet due

  void archive(Archive& a) { a(entered, present, left, waiting_to_enter, scheduled); }
};

/// Agents of one group that cannot reach one of their goals.
struct Stranding {
  uint32_t group = 0;
  uint32_t stop = 0;  ///< index into the route of the group, or kSetGoal
  int people = 0;
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< position of one of them
  Eigen::Vector2d end_m = Eigen::Vector2d::Zero();    ///< nearest point that this one could reach

  static constexpr uint32_t kSetGoal = UINT32_MAX;  ///< a goal set during the run
};

}  // namespace throng
