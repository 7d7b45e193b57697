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
  Rectangle area;
  const FlowField* field = nullptr;
};

class Ways {
 public:
  Ways(const Scene& scene, Workers& workers);
  Ways(const Ways&) = delete;
  Ways& operator=(const Ways&) = delete;

  const Walkable& walkable() const { return walkable_; }
  /// The goals of a group, in order; at least one.
  const std::vector<Stop>& route(size_t group) const { return routes_[group]; }

 private:
  Walkable walkable_;
  FlowGrid grid_;
  std::vector<std::unique_ptr<const FlowField>> fields_;
  std::vector<std::vector<Stop>> routes_;  ///< by group
};

}  // namespace throng
