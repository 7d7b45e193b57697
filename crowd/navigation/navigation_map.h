// What people need to know of a scene to find their way: walls, a navigation mesh, and a flow field
// for every goal. A field answers everybody who has the goal, from anywhere and pushed anywhere, in
// a few nanoseconds; the mesh answers what a field cannot: which pieces of ground are connected,
// and along which corners a single way leads. One rule: shared by spawning and steering, and
// nothing about it changes after construction but that doors open and close.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/workers.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/doorways.h"
#include "crowd/navigation/flow_field.h"
#include "crowd/navigation/nav_mesh.h"
#include "crowd/navigation/queue_plan.h"
#include "crowd/navigation/walkable.h"

namespace throng {

/// One of several ways into a goal: a doorway before it, or one of its areas.
struct Exit {
  /// Leads through no other doorway; to an area, past no other one if that can be helped, as
  /// whoever is there would leave by it: a way as near as kMinOtherExit_m to another counts longer.
  const FlowField* field = nullptr;
  size_t field_number = 0;  ///< the field's number, of NavigationMap::field()
  double width_m = 0;       ///< of the doorway about, or the area's longer side

  static constexpr double kMinOtherExit_m = 3;
};

/// A goal on a route.
struct Stop {
  Goal goal;
  const FlowField* field = nullptr;
  size_t field_number = 0;  ///< the field's number, of NavigationMap::field()
  std::vector<int> pieces;  ///< of the navigation mesh, that the goal lies on
  /// Which of NavigationMap::exits() are this goal's: none, or several.
  uint32_t first_exit = 0;
  uint32_t exits = 0;
  /// Which of NavigationMap::queues() people wait in: then the goal has no exits.
  std::optional<uint32_t> queue;

  bool contains(const Eigen::Vector2d& point) const { return goal.contains(point); }
  /// Returns whether agents stand in no more than one row in an area of the goal.
  bool is_narrow() const {
    constexpr double kTwoRows_m = 0.7;
    return std::any_of(goal.areas.begin(), goal.areas.end(),
                       [](const Rectangle& area) { return area.size_m().minCoeff() < kTwoRows_m; });
  }
  /// The area of the goal that is nearest as the crow flies.
  const Rectangle& nearest_area(const Eigen::Vector2d& point) const;
};

/// A queue, and the ways to it and from it.
struct QueueFields {
  QueuePlan plan;
  std::vector<std::unique_ptr<FlowField>> to_areas, to_corners;  ///< of the goal; of the line
};

enum class DoorState : uint8_t {
  kOpen,
  kClosing,  ///< nobody sets foot into it any more, and it shuts when the last is through
  kShut,
};

/// A TriggerRule, its names looked up.
struct Trigger {
  double delay_s = 0;
  std::optional<uint32_t> group;  ///< none: after the start of the run
  uint32_t goals = 0;             ///< so many that everybody has been at
};

/// When a door opens and closes: indices of occasions.
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
  size_t groups() const { return routes_.size(); }
  /// The goals of a group, in order; at least one.
  const std::vector<Stop>& route(size_t group) const { return routes_[group]; }
  /// Goal by goal.
  const std::vector<Exit>& exits() const { return exits_; }
  /// The fields of all goals and exits, which keep their numbers; those of queues have none.
  size_t field_count() const { return fields_.size() + exit_fields_.size(); }
  const FlowField& field(size_t number) const {
    return number < fields_.size() ? *fields_[number] : *exit_fields_[number - fields_.size()];
  }
  /// Another one once doors have moved and fields with them.
  uint64_t revision() const { return revision_; }
  /// Of goals that people come into one after another, each once: groups often share them.
  const std::vector<QueueFields>& queues() const { return queues_; }
  OnArrival on_arrival(size_t group) const { return on_arrival_[group]; }
  /// Of a scene with groups; a box of parts has none.
  const NavMesh& nav_mesh() const { return *nav_mesh_; }
  /// True if a way leads from a point to a stop, or would but for standing too near an obstacle.
  /// Any thread may ask.
  bool leads(const Stop& stop, const Eigen::Vector2d& point) const;
  /// Where people enter: group by group, in each group's order of sources.
  const std::vector<Rectangle>& entrances() const { return entrances_; }

  /// What groups and doors wait for.
  const std::vector<Trigger>& triggers() const { return triggers_; }
  /// Before which nobody of a group sets out.
  std::optional<uint32_t> after(size_t group) const { return after_[group]; }
  const std::vector<DoorTriggers>& door_triggers() const { return door_triggers_; }
  const std::vector<DoorState>& doors() const { return doors_; }
  /// How far a point is from a door's leaf, and on which side of it.
  Walkable::Nearest nearest_door(size_t door, const Eigen::Vector2d& point) const {
    return walkable_.nearest(walkable_.footprint_of_door(door), point);
  }
  /// From now on doors are as these say. Where one closes or opens for those who look for a way,
  /// all fields are worked out anew.
  void set_doors(std::span<const DoorState> doors, Workers& workers);

 private:
  void resolve_triggers(const CrowdPlan& plan);
  void apply_doors();
  uint32_t add_trigger(const CrowdPlan& plan, const TriggerRule& rule);
  void build_fields(Workers& workers);
  uint32_t add_goal(const Goal& goal);
  uint32_t queue_of(const Goal& goal) const;
  void add_queues(const CrowdPlan& plan);
  void build_queues(Workers& workers);
  std::vector<CellPolicy> penalise_other_goals(std::span<const Rectangle> areas) const;
  void find_exits(Workers& workers);
  void build_exits(Workers& workers);
  std::vector<CellPolicy> avoid_other_exits(uint32_t exit) const;

  Walkable walkable_;
  FlowGrid grid_;
  std::unique_ptr<const NavMesh> nav_mesh_;
  std::vector<std::vector<Rectangle>> goals_;       ///< each once: groups often share them
  std::vector<std::unique_ptr<FlowField>> fields_;  ///< by goal
  std::vector<uint8_t> may_have_exits_;             ///< by goal: not everybody queues for it
  std::vector<uint32_t> first_exits_;               ///< by goal, and the end
  std::vector<QueueFields> queues_;
  // By exit.
  std::vector<Exit> exits_;
  std::vector<size_t> goal_of_exit_;
  std::vector<std::vector<size_t>> doorways_;  ///< the cells to step on; empty: an area
  std::vector<std::unique_ptr<FlowField>> exit_fields_;
  std::vector<std::vector<Stop>> routes_;  ///< by group
  std::vector<OnArrival> on_arrival_;      ///< by group
  std::vector<Rectangle> entrances_;
  std::vector<Trigger> triggers_;
  std::vector<std::optional<uint32_t>> after_;  ///< by group
  // By door.
  std::vector<DoorTriggers> door_triggers_;
  std::vector<DoorState> doors_;
  std::vector<std::vector<size_t>> door_cells_;  ///< that nobody gets past who does not step on one
  std::vector<uint8_t> closed_;                  ///< by cell; empty: no door is closed
  uint64_t revision_ = 0;
};

}  // namespace throng
