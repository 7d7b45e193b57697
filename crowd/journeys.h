// Journeys tracks each agent's progress along its route.
// Invariant: follow(id) depends on that agent's position and the time only; agents can be updated
// in any order.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/archive.h"
#include "base/memory.h"
#include "crowd/crowd_counters.h"
#include "crowd/detours.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"

namespace throng {
namespace tuning {

/// A target is reached within this distance, or after this time inside the goal's area.
inline constexpr double kArrival_m = 0.7;
inline constexpr double kPatience_s = 3.0;
/// At goals with sides up to the first length agents hinder each other or walk in circles. The
/// heuristic does at 0.6 m, but not at 0.8 m. Such a goal reaches out to the second length.
inline constexpr double kSmallGoal_m = 0.7;
inline constexpr double kAroundSmall_m = 1.0;

/// Lateral offset: on the shortest path all agents would follow a corner's inner edge in one file.
/// The offset is limited by the distance to walls beyond the first value and by this share of the
/// remaining path. It is zero below the slow share of the desired speed and full above the fast
/// one. In a queue it would lead into a door's frame. Feet can follow its rate.
inline constexpr double kLateralOffsetFrom_m = 0.45;
inline constexpr double kLateralOffsetShare = 0.2;
inline constexpr double kLateralOffsetSlow = 0.2, kLateralOffsetFast = 0.5;
inline constexpr double kLateralOffsetRate_mps = 0.2;

}  // namespace tuning

enum class JourneyState : uint8_t {
  kOutside,  ///< has not entered yet
  kWaiting,  ///< stands until a time: before setting out, or at a goal
  kWalking,
  kQueuing,   ///< has a position in the queue for a goal
  kStaying,   ///< stays at the last goal for good
  kStranded,  ///< no path leads from here to the goal
  kLeaving,   ///< reached its last goal; will be removed
  kGone,      ///< has left, was removed, or is a spare agent
};

enum class StallCause : uint8_t {
  kNone,
  kStuck,          ///< no progress for tuning::kPatience_s, without time in queues
  kBehindStaying,  ///< an agent ahead stays for good at the same goal, or in a narrow one
};

/// An agent's constant deviation from the shortest path.
struct LateralOffset {
  double offset_m = 0;  ///< positive to the left
  Eigen::Vector2d last_direction =
      Eigen::Vector2d::Zero();  ///< unit vector of the latest direction; zero: unknown

  /// Place whose shortest path an agent at `position_m` follows instead of its own.
  Eigen::Vector2d beside_m(const Eigen::Vector2d& position_m,
                           const Eigen::Vector2d& path_direction) const {
    return position_m + offset_m * Eigen::Vector2d(path_direction.y(), -path_direction.x());
  }
};

class Journeys {
 public:
  /// Keeps references to `map` and `detours`. Agents with an entrance are outside until enter().
  Journeys(const NavigationMap& map, const Detours& detours, std::span<const AgentSpec> people,
           uint64_t seed);

  void archive(Archive& a);

  /// Lets an agent enter at a place.
  void enter(uint32_t id, const Eigen::Vector2d& position_m, double now_s);
  void set_present(uint32_t id, bool is_there) {
    journeys_[id].state = is_there ? JourneyState::kStaying : JourneyState::kOutside;
  }
  /// Removes an agent.
  void leave(uint32_t id);
  /// Sends a present agent at `position_m` to the goals of another route (NavigationMap::route()),
  /// at once.
  void take_route(uint32_t id, size_t route, const Eigen::Vector2d& position_m);
  size_t route(uint32_t id) const { return journeys_[id].route; }
  /// Per route, 1: an agent follows it or may still do so.
  std::vector<uint8_t> routes_in_use() const;

  /// Lets the members of a group set out from `time_s` on. Those of a group with a trigger
  /// (NavigationMap::after()) stand until this call.
  void allow_departure(size_t group, double time_s) { departures_s_[group] = time_s; }
  /// Returns whether an agent has visited this many goals, is stranded, or is not in the scene and
  /// will not enter by itself.
  bool has_visited(uint32_t id, uint32_t goals) const {
    return visits_[id] >= goals || journeys_[id].state == JourneyState::kStranded ||
           journeys_[id].state == JourneyState::kGone;
  }

  /// Updates one agent once per period: arrives, waits, continues. Thread-safe for different ids.
  void follow(uint32_t id, const Eigen::Vector2d& position_m, double now_s, StallCause stall_cause);

  /// Returns the unit direction to walk; zero without a goal or while standing. An agent with a
  /// lateral offset takes the direction of its offset place. Walls at `clearance_m` limit detours.
  Eigen::Vector2d direction(uint32_t id, const Eigen::Vector2d& position_m,
                            const LateralOffset& side = {}, double clearance_m = 1e9) const;

  /// Returns the direction that a waiting agent will walk in; zero if it has none.
  Eigen::Vector2d facing(uint32_t id, const Eigen::Vector2d& position_m) const;

  /// Prefetches what the other prefetch(), and any query of the agent, read first.
  THRONG_PREFETCH void prefetch(uint32_t id) const { __builtin_prefetch(&journeys_[id]); }
  /// Prefetches what direction() of the same arguments reads.
  void prefetch(uint32_t id, const Eigen::Vector2d& position_m,
                const LateralOffset& side = {}) const;

  JourneyState state(uint32_t id) const { return journeys_[id].state; }
  /// Returns the least id of the social group, or the agent's own id without one.
  uint32_t first_member(uint32_t id) const { return first_members_[id]; }
  /// Returns whether an agent at this place has reached the goal it walks to, see has_reached(). It
  /// may still look for a place there. At a goal with a queue, only its own area counts.
  bool is_at_goal(uint32_t id, const Eigen::Vector2d& position_m) const;
  /// Returns whether an agent walks to its last goal, without a queue, to stay there.
  bool walks_to_stay(uint32_t id) const;
  /// Returns whether an agent is at its last goal for good.
  bool is_staying(uint32_t id) const {
    return journeys_[id].state == JourneyState::kStaying ||
           (journeys_[id].state == JourneyState::kWaiting &&
            journeys_[id].next == JourneyState::kStaying);
  }
  /// Returns the number of goals that an agent has visited.
  uint32_t visits(uint32_t id) const { return visits_[id]; }
  bool is_present(uint32_t id) const {
    return journeys_[id].state != JourneyState::kOutside &&
           journeys_[id].state != JourneyState::kGone;
  }
  /// The goal that the agent walks to or stands at.
  const Stop& stop(uint32_t id) const {
    return map_.route(journeys_[id].route)[journeys_[id].stop];
  }

  /// Index into NavigationMap::exits() for agents that walk to a goal with several exits, kOpen
  /// before they have chosen. kNoExit for all others.
  uint32_t exit(uint32_t id) const { return journeys_[id].exit; }
  static constexpr uint32_t kNoExit = UINT32_MAX;
  static constexpr uint32_t kOpen = UINT32_MAX - 1;
  /// Sets the exit of an agent that walks to a goal with several exits.
  void take_exit(uint32_t id, uint32_t exit) { journeys_[id].exit = exit; }
  /// Returns whether an agent walks to a goal with a queue and has no position in it yet.
  bool seeks_queue(uint32_t id) const {
    return journeys_[id].state == JourneyState::kWalking && !areas_.empty() && !is_admitted(id) &&
           stop(id).queue;
  }
  /// Returns whether an agent may enter its goal with a queue, namely area(), until it has been
  /// there.
  bool is_admitted(uint32_t id) const { return !areas_.empty() && areas_[id] != kNoArea; }
  uint32_t area(uint32_t id) const { return areas_[id]; }
  /// Gives an agent for which seeks_queue() is true a position in the queue.
  void join_queue(uint32_t id) { journeys_[id].state = JourneyState::kQueuing; }
  /// Sends an agent in a queue to this area of the goal.
  void admit(uint32_t id, uint32_t area, const Eigen::Vector2d& position_m);
  static constexpr uint32_t kNoCorner = UINT32_MAX;
  /// Sets where an agent in a queue, or walking to one, goes in this period. The direction has a
  /// length of up to 1. `corner` selects the field of a corner of the line; kNoCorner: the goal's.
  void guide(uint32_t id, const Eigen::Vector2d& path_direction, uint32_t corner) {
    guides_[id] = {path_direction, corner};
  }

  /// The field that an agent follows; before it has chosen an exit, that to the nearest one.
  const FlowField& field(uint32_t id) const {
    if (journeys_[id].exit < kOpen) return *map_.exits()[journeys_[id].exit].field;
    if (!areas_.empty() && stop(id).queue) return queue_field(id);
    return *stop(id).field;
  }

  /// Returns all stranded agents by group and stop. One caller at a time.
  std::vector<Stranding> strandings(std::span<const Eigen::Vector2d> positions_m) const;

 private:
  double departure_s(uint32_t id) const {
    return departures_s_[map_.group_of(journeys_[id].route)];
  }
  void set_out(uint32_t id, const Eigen::Vector2d& position_m);
  void arrive(uint32_t id, const Eigen::Vector2d& position_m, double now_s);
  std::span<const Area> areas_of_goal(uint32_t id) const;
  bool is_round_small_goal(uint32_t id, const Eigen::Vector2d& position_m) const;
  bool is_beside_goal(uint32_t id, const Eigen::Vector2d& position_m) const;
  bool is_last_stop(uint32_t id) const {
    return journeys_[id].stop + 1 == map_.route(journeys_[id].route).size();
  }
  double draw_wait_s(uint32_t id) const;
  const FlowField& queue_field(uint32_t id) const;
  std::optional<size_t> detour_number(uint32_t id) const;
  Eigen::Vector2d detoured_direction(uint32_t id, const Eigen::Vector2d& position_m,
                                     const Eigen::Vector2d& along) const;
  void choose_target(uint32_t id, const Eigen::Vector2d& position_m);

  const NavigationMap& map_;
  const Detours& detours_;
  uint64_t seed_;
  /// Data that directions need: a quarter of a cache line.
  struct Journey {
    uint32_t route = 0;       ///< index into NavigationMap::route(): the group, or a goal set later
    uint32_t stop = 0;        ///< index into the route
    uint32_t exit = kNoExit;  ///< see exit()
    JourneyState state = JourneyState::kOutside;
    JourneyState next = JourneyState::kWalking;  ///< after waiting
    void archive(Archive& a) { a(route, stop, exit, state, next); }
  };
  // By id.
  std::vector<Journey> journeys_;
  std::vector<double> delays_s_;
  std::vector<double> radii_m_;          ///< disc radii
  std::vector<uint32_t> first_members_;  ///< member whose place determines its place, or itself
  std::vector<double> until_s_;   ///< end of waiting; inside a goal: when to accept any place
  std::vector<uint32_t> visits_;  ///< goals visited, the counter of random places
  std::vector<Eigen::Vector2d> targets_m_;  ///< place inside the goal
  static constexpr uint32_t kNoArea = UINT32_MAX;
  /// Direction in the current period, for agents guided by Queues.
  struct Guide {
    Eigen::Vector2d path_direction = Eigen::Vector2d::Zero();
    uint32_t corner = kNoCorner;
    void archive(Archive& a) { a(path_direction, corner); }
  };
  // Empty without queues.
  std::vector<uint32_t> areas_;  ///< area of the goal that the agent may enter
  std::vector<Guide> guides_;
  std::vector<double> departures_s_;  ///< per group: infinity until its trigger
};

/// Returns one line for the user: agents, goal, place, and the obstacle in the way.
std::string describe(const Stranding& stranding, const CrowdPlan& plan);

}  // namespace throng
