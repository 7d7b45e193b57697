// Population admits and removes agents during a run: those of sources, and by the run's program.
// Invariant: each agent is outside, present or gone. No agent is placed on another; an agent
// without room waits outside and is counted.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "crowd/crowd_counters.h"
#include "crowd/journeys.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"

namespace throng {

class Population {
 public:
  /// Keeps a reference to `map`.
  Population(const NavigationMap& map, std::span<const AgentSpec> people, uint64_t seed);

  /// Returns false as long as no agent can enter or leave: only remove() may then be called.
  bool is_open() const { return is_open_; }
  /// One per agent: 1 in the scene, 0 outside or gone.
  std::span<const uint8_t> present() const { return present_; }
  const PopulationCounters& counters() const { return counters_; }

  void archive(Archive& a);

  void set_present(uint32_t id, bool is_there) { present_[id] = is_there ? 1 : 0; }
  /// Number of agents that a group can still add, and the id of the first; ids are consecutive.
  uint32_t spares(size_t group) const { return spares_[group].end - spares_[group].next; }
  uint32_t first_spare(size_t group) const { return spares_[group].next; }
  /// Admits the next spare agents of a group.
  void add_spares(size_t group, uint32_t count);
  /// Removes a present agent.
  void remove(uint32_t id);
  /// Removes agents that are leaving.
  void release(Journeys& journeys);

  /// Admits agents that are due and fit between the discs at `positions_m`: writes their positions
  /// there and their ids to entered(). Allocates nothing.
  void admit(double now_s, Journeys& journeys, std::span<Eigen::Vector2d> positions_m);
  /// Ids admitted by the latest admit(), ascending by entrance.
  std::span<const uint32_t> entered() const { return entered_; }

 private:
  /// Agents of one entrance have consecutive ids and ascending times.
  struct Entrance {
    Area area;
    bool has_path = false;  ///< whether some part of the area has a path to the first goal
    uint32_t next = 0;
    uint32_t end = 0;
  };

  /// Spare agents of one group, which have consecutive ids.
  struct Spares {
    uint32_t next = 0;
    uint32_t end = 0;
  };

  void open();
  bool has_due(double now_s) const;
  void list_nearby(const Entrance& entrance, std::span<const Eigen::Vector2d> positions_m);
  bool find_place(const Entrance& entrance, std::span<Eigen::Vector2d> positions_m,
                  uint64_t decision);
  void count(double now_s);

  const NavigationMap& map_;
  uint64_t seed_;
  bool is_open_ = false;
  std::vector<Entrance> entrances_;
  std::vector<Spares> spares_;             ///< per group
  std::vector<uint32_t> groups_;           ///< per id
  std::vector<uint8_t> follows_previous_;  ///< 1: enters with the previous id
  std::vector<double> radii_m_;
  std::vector<double> wall_gaps_m_;
  double max_radius_m_ = 0;
  std::vector<double> enters_s_;
  std::vector<uint8_t> present_;
  std::vector<uint32_t> nearby_;  ///< agents near the current entrance
  std::vector<uint32_t> entered_;
  uint64_t decisions_ = 0;
  PopulationCounters counters_;
};

}  // namespace throng
