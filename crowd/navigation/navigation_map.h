// NavigationMap contains what agents need to find their way: walls, a navigation mesh, and a flow
// field per goal. A field gives all agents with that goal the direction from any place, in a few
// nanoseconds. The mesh knows which pieces of ground are connected, and along which corners a
// single path leads.
// Invariant: shared by spawning and steering, and immutable except for doors and for goals set
// during the run.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/workers.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/doorways.h"
#include "crowd/navigation/flow_field.h"
#include "crowd/navigation/nav_mesh.h"
#include "crowd/navigation/queue_plan.h"
#include "crowd/navigation/walkable.h"

namespace throng {

/// One of several exits of a goal: a doorway before it, or one of its areas.
struct Exit {
  /// Field that avoids all other doorways and, where possible, passes kMinOtherExit_m clear of
  /// other exit areas, because an agent there would leave by them.
  const FlowField* field = nullptr;
  size_t field_number = 0;  ///< for NavigationMap::field()
  double width_m = 0;       ///< width of the doorway, approximate, or the area's longer side

  static constexpr double kMinOtherExit_m = 3;
};

struct Stop {
  Goal goal;
  const FlowField* field = nullptr;
  size_t field_number = 0;  ///< for NavigationMap::field(), or kNoNumber: its field has none
  std::vector<int> pieces;  ///< pieces of the navigation mesh under the goal
  /// Range in NavigationMap::exits(); empty or at least two.
  uint32_t first_exit = 0;
  uint32_t exits = 0;
  /// Index into NavigationMap::queues(); a goal with a queue has no exits.
  std::optional<uint32_t> queue;

  static constexpr size_t kNoNumber = SIZE_MAX;

  bool contains(const Eigen::Vector2d& point) const { return goal.contains(point); }
  /// Returns whether an area of the goal holds no more than one row of agents.
  bool is_narrow() const {
    constexpr double kTwoRows_m = 0.7;
    return std::any_of(goal.areas.begin(), goal.areas.end(),
                       [](const Area& area) { return area.size_m().minCoeff() < kTwoRows_m; });
  }
  /// The area of the goal nearest in a straight line.
  const Area& nearest_area(const Eigen::Vector2d& point) const;
};

/// A queue and the fields to its goal and line.
struct QueueFields {
  QueuePlan plan;
  /// fields to the goal; to the line
  std::vector<std::unique_ptr<FlowField>> to_areas, to_corners;
};

enum class DoorState : uint8_t {
  kOpen,
  kClosing,  ///< no agent enters the leaf; it shuts after the last one has left
  kShut,
};

/// A TriggerRule with resolved names.
struct Trigger {
  double delay_s = 0;
  std::optional<uint32_t> group;  ///< none: after the start of the run
  uint32_t goals = 0;  ///< number of goals that all agents of the group must have visited
};

/// Indices of the triggers on which a door opens and closes.
struct DoorTriggers {
  std::vector<uint32_t> opens, closes;
};

class NavigationMap {
 public:
  NavigationMap(const CrowdPlan& plan, Workers& workers);
  NavigationMap(const NavigationMap&) = delete;
  NavigationMap& operator=(const NavigationMap&) = delete;

  const Walkable& walkable() const { return walkable_; }
  const FlowGrid& grid() const { return grid_; }
  size_t groups() const { return on_arrival_.size(); }
  /// One per group, followed by those of route_to().
  size_t routes() const { return routes_.size(); }
  /// The goals of a route, in order; at least one.
  const std::vector<Stop>& route(size_t route) const { return routes_[route]; }
  bool is_set_goal(size_t route) const { return route >= groups(); }
  size_t group_of(size_t route) const {
    return is_set_goal(route) ? set_goals_[route - groups()].group : route;
  }
  /// Returns a route of a group to one goal without a queue. It replaces one that is not in use
  /// (`is_used`, per route). Paths to an area of the scene's goals choose between its doorways and
  /// lead around crowds; to other areas they are the shortest. Throws InputError if there are too
  /// many routes.
  size_t route_to(size_t group, const Goal& goal, std::span<const uint8_t> is_used);
  /// Saves or restores the goals that were set.
  void archive(Archive& a);
  /// Goal by goal.
  const std::vector<Exit>& exits() const { return exits_; }
  /// Number of fields of goals and exits. Their numbers are constant; fields of queues have none.
  size_t field_count() const { return fields_.size() + exit_fields_.size(); }
  const FlowField& field(size_t number) const {
    return number < fields_.size() ? *fields_[number] : *exit_fields_[number - fields_.size()];
  }
  /// Changes when doors and fields change.
  uint64_t revision() const { return revision_; }
  /// Limited goals, each once: groups often share them.
  const std::vector<QueueFields>& queues() const { return queues_; }
  OnArrival on_arrival(size_t route) const { return on_arrival_[group_of(route)]; }
  /// Only for a scene with groups; a scene with a box has none.
  const NavMesh& nav_mesh() const { return *nav_mesh_; }
  /// Returns whether a path leads to a stop, ignoring obstacles' margin at `point`. Thread-safe.
  bool leads(const Stop& stop, const Eigen::Vector2d& point) const;
  /// Areas of sources, in the order of groups and their sources.
  const std::vector<Area>& entrances() const { return entrances_; }

  const std::vector<Trigger>& triggers() const { return triggers_; }
  /// Trigger before which no agent of a group sets out.
  std::optional<uint32_t> after(size_t group) const { return after_[group]; }
  const std::vector<DoorTriggers>& door_triggers() const { return door_triggers_; }
  const std::vector<DoorState>& doors() const { return doors_; }
  /// Distance and normal from a door's leaf to a point.
  Walkable::Nearest nearest_door(size_t door, const Eigen::Vector2d& point) const {
    return walkable_.nearest(walkable_.footprint_of_door(door), point);
  }
  /// Sets the states of all doors. Rebuilds all fields if a door opens or closes for path finding.
  void set_doors(std::span<const DoorState> doors, Workers& workers);

 private:
  bool is_open_along(const FlowField& field, const Eigen::Vector2d& point) const;
  void resolve_triggers(const CrowdPlan& plan);
  void apply_doors();
  uint32_t add_trigger(const CrowdPlan& plan, const TriggerRule& rule);
  void build_fields(Workers& workers);
  uint32_t add_goal(const Goal& goal);
  Stop stop_at(const Goal& goal, uint32_t index) const;
  size_t max_set_goals() const;
  void build_set_goal(size_t index);
  uint32_t queue_of(const Goal& goal) const;
  void add_queues(const CrowdPlan& plan);
  void build_queues(Workers& workers);
  FlowField field_to(std::span<const Area> areas) const;
  std::vector<CellPolicy> penalise_other_goals(std::span<const Area> areas) const;
  void find_exits(Workers& workers);
  void build_exits(Workers& workers);
  std::vector<CellPolicy> avoid_other_exits(uint32_t exit) const;

  Walkable walkable_;
  FlowGrid grid_;
  std::unique_ptr<const NavMesh> nav_mesh_;
  std::vector<std::vector<Area>> goals_;            ///< each once: groups often share them
  std::vector<std::unique_ptr<FlowField>> fields_;  ///< per goal
  std::vector<uint8_t> may_have_exits_;             ///< per goal: some group does not queue for it
  std::vector<uint32_t> first_exits_;               ///< per goal, and the end
  std::vector<QueueFields> queues_;
  // By exit.
  std::vector<Exit> exits_;
  std::vector<size_t> goal_of_exit_;
  std::vector<std::vector<size_t>> doorways_;  ///< cells that paths cross; empty: an area
  std::vector<std::unique_ptr<FlowField>> exit_fields_;
  struct SetGoal {
    size_t group = 0;
    Goal goal;
    std::unique_ptr<FlowField> field;  ///< null for areas of a goal of the scene
  };
  std::vector<std::vector<Stop>> routes_;  ///< per group, then per set goal
  std::vector<SetGoal> set_goals_;
  std::vector<OnArrival> on_arrival_;  ///< per group
  std::vector<Area> entrances_;
  std::vector<Trigger> triggers_;
  std::vector<std::optional<uint32_t>> after_;  ///< per group
  // By door.
  std::vector<DoorTriggers> door_triggers_;
  std::vector<DoorState> doors_;
  std::vector<std::vector<size_t>> door_cells_;  ///< cells that every path through the door crosses
  std::vector<uint8_t> closed_;                  ///< per cell; empty: no door is closed
  uint64_t revision_ = 0;
};

}  // namespace throng
