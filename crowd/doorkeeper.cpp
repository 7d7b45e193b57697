#include "crowd/doorkeeper.h"

#include <algorithm>
#include <limits>

namespace throng {
namespace {

constexpr double kBefore = -1;  // of all moments
/// Doors farther off stop nobody yet.
constexpr double kReach_m = 3;
/// People stand so far from a closed leaf.
constexpr double kGap_m = 0.15;
/// Whoever would pass beside the leaf by more than this does not go through it.
constexpr double kBesideDoor_m = 0.2;

}  // namespace

Doorkeeper::Doorkeeper(Ways& ways, std::span<const double> radii_m, Workers& workers)
    : ways_(ways),
      workers_(workers),
      radii_m_(radii_m.begin(), radii_m.end()),
      states_(ways.doors()),
      since_s_(states_.size(), kBefore) {}

void Doorkeeper::archive(Archive& a) {
  a(states_, since_s_);
  if (!a.is_reading()) return;
  for (const DoorState state : states_)
    if (state > DoorState::kShut) a.refuse("a door open, closing or shut", "another");
  for (const double since_s : since_s_)
    if (!(since_s >= kBefore)) a.refuse("a moment of a door", "another");
  ways_.set_doors(states_, workers_);
}

void Doorkeeper::follow(const Occasions& occasions, std::span<const uint8_t> present,
                        std::span<const Eigen::Vector2d> positions_m, double now_s) {
  for (size_t door = 0; door < states_.size(); ++door) {
    double& since_s = since_s_[door];
    const auto obey = [&](const std::vector<uint32_t>& times, bool opens) {
      for (const uint32_t occasion : times) {
        const double time_s = occasions.time_s(occasion);
        // Of an opening and a closing at the same moment, the closing counts: it comes second.
        if (time_s > now_s || time_s < since_s || (opens && time_s == since_s)) continue;
        since_s = time_s;
        if (opens)
          states_[door] = DoorState::kOpen;
        else if (states_[door] == DoorState::kOpen)
          states_[door] = DoorState::kClosing;
      }
    };
    const DoorTimes& times = ways_.door_times()[door];
    obey(times.opens, true);
    obey(times.closes, false);
    if (states_[door] == DoorState::kClosing && is_free(door, present, positions_m))
      states_[door] = DoorState::kShut;
  }
  ways_.set_doors(states_, workers_);
}

bool Doorkeeper::is_free(size_t door, std::span<const uint8_t> present,
                         std::span<const Eigen::Vector2d> positions_m) const {
  for (size_t id = 0; id < positions_m.size(); ++id)
    if (present[id] != 0 && ways_.nearest_door(door, positions_m[id]).distance_m < radii_m_[id])
      return false;
  return true;
}

double Doorkeeper::room_m(const Eigen::Vector2d& position_m, const Eigen::Vector2d& way,
                          double radius_m) const {
  double room_m = std::numeric_limits<double>::infinity();
  for (size_t door = 0; door < states_.size(); ++door) {
    if (states_[door] == DoorState::kOpen) continue;
    const Walkable::Nearest leaf = ways_.nearest_door(door, position_m);
    if (leaf.distance_m > kReach_m) continue;
    if (states_[door] == DoorState::kClosing && leaf.distance_m < radius_m) continue;
    const double into = -way.dot(leaf.normal);
    if (into < 0.2) continue;
    const double ahead_m = std::max(leaf.distance_m, 0.0) / into;
    if (ways_.nearest_door(door, position_m + ahead_m * way).distance_m > kBesideDoor_m) continue;
    room_m = std::min(room_m, leaf.distance_m - radius_m - kGap_m);
  }
  return room_m;
}

}  // namespace throng
