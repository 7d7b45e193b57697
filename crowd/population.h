// People who come in and go out while a scene runs.
// One rule: nobody is placed where somebody stands, and everybody is outside, present or gone;
// whoever finds no room waits outside and is counted.
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

  /// True if anybody may ever enter or leave: otherwise all of this costs nothing.
  bool is_open() const { return is_open_; }
  /// One a person: 1 in the scene, 0 outside or gone.
  std::span<const uint8_t> present() const { return present_; }
  const PopulationCounters& counters() const { return counters_; }

  /// Everything that release() and admit() may have changed.
  void archive(Archive& a);

  /// Somebody who is led is there, or is not.
  void set_present(uint32_t id, bool is_there) { present_[id] = is_there ? 1 : 0; }
  /// Takes out whoever is leaving.
  void release(Journeys& journeys);

  /// Brings in whoever is due and finds room among the discs of `positions_m`: writes the place
  /// there, and the ids into entered(). No allocation.
  void admit(double now_s, Journeys& journeys, std::span<Eigen::Vector2d> positions_m);
  /// Of the latest admit(), ascending by entrance.
  std::span<const uint32_t> entered() const { return entered_; }

 private:
  /// Those of one entrance have consecutive ids and ascending times.
  struct Entrance {
    Rectangle area;
    bool has_way = false;  ///< from some of it, to the first goal
    uint32_t next = 0;
    uint32_t end = 0;
  };

  bool has_due(double now_s) const;
  void list_nearby(const Entrance& entrance, std::span<const Eigen::Vector2d> positions_m);
  bool find_place(const Entrance& entrance, std::span<Eigen::Vector2d> positions_m,
                  uint64_t decision);
  void count(double now_s);

  const NavigationMap& map_;
  uint64_t seed_;
  bool is_open_ = false;
  std::vector<Entrance> entrances_;
  std::vector<uint32_t> groups_;           ///< by person
  std::vector<uint8_t> follows_previous_;  ///< 1: comes with the one before
  std::vector<double> radii_m_;
  std::vector<double> wall_gaps_m_;
  double max_radius_m_ = 0;
  std::vector<double> enters_s_;
  std::vector<uint8_t> present_;
  std::vector<uint32_t> nearby_;  ///< who stands near the entrance in question
  std::vector<uint32_t> entered_;
  uint64_t decisions_ = 0;
  PopulationCounters counters_;
};

}  // namespace throng
