#include "crowd/door_controller.h"

#include <algorithm>
#include <limits>

namespace throng {
namespace {

constexpr double kBefore = -1;  // before all times
/// Doors farther off are ignored.
constexpr double kReach_m = 3;
/// Distance that agents keep from a closed leaf.
constexpr double kGap_m = 0.15;
/// An agent that would pass next to the leaf by more than this does not go through it.
constexpr double kBesideDoor_m = 0.2;

}  // namespace

DoorController::DoorController(NavigationMap& map, std::span<const double> radii_m,
                               Workers& workers)
    : map_(map),
      workers_(workers),
      radii_m_(radii_m.begin(), radii_m.end()),
      states_(map.doors()),
      last_changes_s_(states_.size(), kBefore) {}

void DoorController::archive(Archive& a) {
  a(states_, last_changes_s_);
  if (!a.is_reading()) return;
  for (const DoorState state : states_)
    if (state > DoorState::kShut) a.reject("a door open, closing or shut", "another value");
  for (const double last_change_s : last_changes_s_)
    if (!(last_change_s >= kBefore)) a.reject("the time of a door's last change", "another value");
  map_.set_doors(states_, workers_);
}

void DoorController::follow(const Triggers& triggers, std::span<const uint8_t> present,
                            std::span<const Eigen::Vector2d> positions_m, double now_s) {
  for (size_t door = 0; door < states_.size(); ++door) {
    double& last_change_s = last_changes_s_[door];
    const auto apply = [&](const std::vector<uint32_t>& times, bool opens) {
      for (const uint32_t trigger : times) {
        const double time_s = triggers.time_s(trigger);
        // Closing wins over opening at the same time: it comes second.
        if (time_s > now_s || time_s < last_change_s || (opens && time_s == last_change_s))
          continue;
        last_change_s = time_s;
        if (opens)
          states_[door] = DoorState::kOpen;
        else if (states_[door] == DoorState::kOpen)
          states_[door] = DoorState::kClosing;
      }
    };
    const DoorTriggers& times = map_.door_triggers()[door];
    apply(times.opens, true);
    apply(times.closes, false);
    if (states_[door] == DoorState::kClosing && is_free(door, present, positions_m))
      states_[door] = DoorState::kShut;
  }
  map_.set_doors(states_, workers_);
}

bool DoorController::is_free(size_t door, std::span<const uint8_t> present,
                             std::span<const Eigen::Vector2d> positions_m) const {
  for (size_t id = 0; id < positions_m.size(); ++id)
    if (present[id] != 0 && map_.nearest_door(door, positions_m[id]).distance_m < radii_m_[id])
      return false;
  return true;
}

double DoorController::free_path_m(const Eigen::Vector2d& position_m,
                                   const Eigen::Vector2d& direction, double radius_m) const {
  double free_path_m = std::numeric_limits<double>::infinity();
  for (size_t door = 0; door < states_.size(); ++door) {
    if (states_[door] == DoorState::kOpen) continue;
    const Walkable::Nearest leaf = map_.nearest_door(door, position_m);
    if (leaf.distance_m > kReach_m) continue;
    if (states_[door] == DoorState::kClosing && leaf.distance_m < radius_m) continue;
    const double into = -direction.dot(leaf.normal);
    if (into < 0.2) continue;
    const double ahead_m = std::max(leaf.distance_m, 0.0) / into;
    if (map_.nearest_door(door, position_m + ahead_m * direction).distance_m > kBesideDoor_m)
      continue;
    free_path_m = std::min(free_path_m, leaf.distance_m - radius_m - kGap_m);
  }
  return free_path_m;
}

}  // namespace throng
