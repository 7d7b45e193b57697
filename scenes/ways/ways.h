// What people need to know of a scene to find their way: walls, a navigation mesh, and a flow field
// for every goal. A field answers everybody who has the goal, from anywhere and pushed anywhere, in
// a few nanoseconds; the mesh answers what a field cannot: which pieces of ground are connected,
// and along which corners a single way leads. One rule: immutable after construction, shared by
// spawning and steering.
#pragma once

#include <memory>
#include <vector>

#include "base/workers.h"
#include "scenes/file/scene.h"
#include "scenes/ways/flow_field.h"
#include "scenes/ways/nav_mesh.h"
#include "scenes/ways/walkable.h"

namespace throng {

/// A goal on a route.
struct Stop {
  Goal goal;
  const FlowField* field = nullptr;
  std::vector<int> pieces;  ///< of the navigation mesh, that the goal lies on

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
  /// Of a scene with groups; a box of parts has none.
  const NavMesh& nav_mesh() const { return *nav_mesh_; }
  /// True if a way leads from a point to a stop, or would but for standing too near an obstacle.
  /// Any thread may ask.
  bool leads(const Stop& stop, const Eigen::Vector2d& point) const;
  /// Where people enter: group by group, in each group's order of sources.
  const std::vector<Rectangle>& entrances() const { return entrances_; }

 private:
  Walkable walkable_;
  FlowGrid grid_;
  std::unique_ptr<const NavMesh> nav_mesh_;
  std::vector<std::unique_ptr<const FlowField>> fields_;
  std::vector<std::vector<Stop>> routes_;  ///< by group
  std::vector<OnArrival> on_arrival_;      ///< by group
  std::vector<Rectangle> entrances_;
};

}  // namespace throng
