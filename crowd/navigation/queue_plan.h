// QueuePlan places the positions of a queue: along a line, beyond its end while there is ground,
// then on free ground near the end.
// Invariant: depends only on the plan and the maximum number of queuing agents.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "crowd/crowd_plan.h"
#include "crowd/navigation/flow_field.h"
#include "crowd/navigation/walkable.h"

namespace throng {

/// A polyline; the first agent stands at its first corner.
class QueueLine {
 public:
  QueueLine() = default;
  explicit QueueLine(std::vector<Eigen::Vector2d> corners_m);

  const std::vector<Eigen::Vector2d>& corners_m() const { return corners_m_; }
  double length_m() const { return ends_m_.empty() ? 0 : ends_m_.back(); }
  /// Returns the point at this distance from the first corner, clamped to the ends.
  Eigen::Vector2d at(double along_m) const;
  /// Returns the distance along the line of its point nearest to `point`, within [from_m, to_m].
  double nearest_m(const Eigen::Vector2d& point, double from_m, double to_m) const;
  /// Returns the corner nearest to a point of the line that is also visible from it.
  size_t nearest_corner(double along_m) const;

 private:
  std::vector<Eigen::Vector2d> corners_m_;
  std::vector<double> ends_m_;  ///< distance of each corner along the line
};

struct QueuePlan {
  QueuePlan(const Goal& goal, const Walkable& walkable, int64_t people);

  std::vector<Area> areas;
  uint32_t max_inside = 1;  ///< per area
  double spacing_m = 0;
  QueueLine line;  ///< includes its extension beyond the end
  /// Number of positions on the line; further agents use overflow positions.
  size_t places = 0;
  int64_t people = 0;  ///< maximum number of agents that may queue here
  /// By area: unit vector that served agents face; none: any direction.
  std::vector<Eigen::Vector2d> fronts;
  /// Positions off the line, by walking distance to its end. Set by find_overflow_positions().
  std::vector<Eigen::Vector2d> overflow_positions_m;

  /// Finds `overflow_positions_m`; `to_end` is the flow field to the end of the line.
  void find_overflow_positions(const Walkable& walkable, const FlowField& to_end);

  double along_m(size_t place) const { return spacing_m * static_cast<double>(place); }

 private:
  bool is_clear(const Walkable& walkable, const Eigen::Vector2d& point) const;
};

}  // namespace throng
