// Doors while a scene runs: they open and close at their times, and people wait before closed ones.
// One rule: a door shuts when nobody stands in it, so that it shuts on nobody.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/workers.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/triggers.h"

namespace throng {

class DoorController {
 public:
  /// Keeps references to `map` and `workers`. Radii are those of steering discs, by person.
  DoorController(NavigationMap& map, std::span<const double> radii_m, Workers& workers);

  /// True if there are doors: otherwise all of this costs nothing.
  bool has_doors() const { return !states_.empty(); }

  /// Everything that follow() may have changed; the ways are then as it was.
  void archive(Archive& a);

  /// Once a decision: opens, closes, shuts.
  void follow(const Triggers& triggers, std::span<const uint8_t> present,
              std::span<const Eigen::Vector2d> positions_m, double now_s);

  /// How far somebody may go on from here before a closed door stops them: infinite where none is
  /// on this way (a unit vector) within some metres, or where they stand in it and go on.
  double free_path_m(const Eigen::Vector2d& position_m, const Eigen::Vector2d& direction,
                     double radius_m) const;

 private:
  bool is_free(size_t door, std::span<const uint8_t> present,
               std::span<const Eigen::Vector2d> positions_m) const;

  NavigationMap& map_;
  Workers& workers_;
  std::vector<double> radii_m_;
  // By door.
  std::vector<DoorState> states_;
  std::vector<double> last_changes_s_;  ///< the moment that it last obeyed
};

}  // namespace throng
