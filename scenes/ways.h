// What people need to know of a scene to find their way: walls, and a flow field for every goal.
// One rule: immutable after construction, shared by spawning and steering.
#pragma once

#include <memory>
#include <vector>

#include "base/workers.h"
#include "scenes/flow_field.h"
#include "scenes/scene.h"
#include "scenes/walkable.h"

namespace throng {

/// A goal on a route.
struct Stop {
  Goal goal;
  const FlowField* field = nullptr;

  bool contains(const Eigen::Vector2d& point) const { return goal.contains(point); }
  /// The area of the goal that is nearest as the crow flies.
  const Rectangle& area_near(const Eigen::Vector2d& point) const;
};

class Ways {
 public:
  Ways(const Scene& scene, Workers& workers);
  Ways(const Ways&) = delete;
  Ways& operator=(const Ways&) = delete;

  const Walkable& walkable() const { return walkable_; }
  /// The goals of a group, in order; at least one.
  const std::vector<Stop>& route(size_t group) const { return routes_[group]; }
  OnArrival on_arrival(size_t group) const { return on_arrival_[group]; }
  /// True if a way leads from a point to a stop, or would but for standing too near an obstacle.
  bool leads(const Stop& stop, const Eigen::Vector2d& point) const;
  /// Where people enter: group by group, in each group's order of sources.
  const std::vector<Rectangle>& entrances() const { return entrances_; }

 private:
  Walkable walkable_;
  FlowGrid grid_;
  std::vector<std::unique_ptr<const FlowField>> fields_;
  std::vector<std::vector<Stop>> routes_;  ///< by group
  std::vector<OnArrival> on_arrival_;      ///< by group
  std::vector<Rectangle> entrances_;
};

}  // namespace throng
