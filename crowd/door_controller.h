// DoorController opens and closes doors on their triggers and stops agents at closed ones.
// Invariant: a closing door shuts only after the last agent has left its leaf.
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
  /// Keeps references to `map` and `workers`. `radii_m` of steering discs, by id.
  DoorController(NavigationMap& map, std::span<const double> radii_m, Workers& workers);

  /// Returns false without doors: no other call is then needed.
  bool has_doors() const { return !states_.empty(); }

  /// Saves or restores all state that follow() may change, and updates the map to it.
  void archive(Archive& a);

  /// Opens, closes and shuts doors. To be called once per period.
  void follow(const Triggers& triggers, std::span<const uint8_t> present,
              std::span<const Eigen::Vector2d> positions_m, double now_s);

  /// Returns the free distance along `direction` (unit) before a closed door. Infinite without a
  /// closed door within some metres, or if the agent already stands in its leaf.
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
  std::vector<double> last_changes_s_;  ///< trigger time last applied
};

}  // namespace throng
