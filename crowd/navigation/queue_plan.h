// Where people stand who wait for their turn at a goal: places along a line, beyond its end as long
// as there is ground, and then wherever there is some near it.
// One rule: it follows from the plan alone, and from how many people may ever queue.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "crowd/crowd_plan.h"
#include "crowd/navigation/flow_field.h"
#include "crowd/navigation/walkable.h"

namespace throng {

/// Straight from corner to corner; the first person stands at the first.
class QueueLine {
 public:
  QueueLine() = default;
  explicit QueueLine(std::vector<Eigen::Vector2d> corners_m);

  const std::vector<Eigen::Vector2d>& corners_m() const { return corners_m_; }
  double length_m() const { return ends_m_.empty() ? 0 : ends_m_.back(); }
  /// The point so far from the first corner; corners where that is beyond an end.
  Eigen::Vector2d at(double along_m) const;
  /// How far along the nearest point is, of those from `from_m` to `to_m`.
  double nearest_m(const Eigen::Vector2d& point, double from_m, double to_m) const;
  /// The corner that is nearest to a point of the line, and in sight of it.
  size_t nearest_corner(double along_m) const;

 private:
  std::vector<Eigen::Vector2d> corners_m_;
  std::vector<double> ends_m_;  ///< how far along each corner is
};

/// A goal that people come into one after another.
struct QueuePlan {
  QueuePlan(const Goal& goal, const Walkable& walkable, int64_t people);

  std::vector<Rectangle> areas;
  uint32_t max_inside = 1;  ///< of each area
  double spacing_m = 0;
  QueueLine line;  ///< with what lies beyond its end
  /// So many stand on the line, at most; those after them elsewhere.
  size_t places = 0;
  int64_t people = 0;  ///< who may queue here, in all
  /// By area: a unit vector to what people face who are served there; none: as they like.
  std::vector<Eigen::Vector2d> fronts;
  /// Elsewhere: the nearest to the end first, by the way on foot. Found by
  /// find_overflow_positions().
  std::vector<Eigen::Vector2d> overflow_positions_m;

  /// Finds `overflow_positions_m`; `to_end` leads to the end of the line.
  void find_overflow_positions(const Walkable& walkable, const FlowField& to_end);

  double along_m(size_t place) const { return spacing_m * static_cast<double>(place); }

 private:
  bool is_clear(const Walkable& walkable, const Eigen::Vector2d& point) const;
};

}  // namespace throng
