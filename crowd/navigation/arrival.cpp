#include "crowd/navigation/arrival.h"

namespace throng {
namespace {

/// Agents decide ten times per second: the fastest walk 0.2 m in between and miss shallower areas.
constexpr double kStep_m = 0.3;
/// Cosine: a wall is behind a point if its normal points back to the agent within 60 degrees.
constexpr double kAhead = -0.5;
/// Inset of the test of free space: an area flush with an obstacle is not free, one in a slot is.
constexpr double kFree_m = 1e-3;

struct NearestPoint {
  NearestPoint(const Area& area, const Eigen::Vector2d& from)
      : nearest_m(area.nearest_m(from)), left_m((nearest_m - from).norm()) {
    if (left_m > 0) direction = (nearest_m - from) / left_m;
  }
  Eigen::Vector2d nearest_m;
  double left_m;
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();  ///< unit; zero inside
};

/// Distance before a point at which walls behind it stop a centre that keeps `gap_m` from them.
double stopping_distance_m(const Walkable& walkable, const NearestPoint& to, double gap_m) {
  Eigen::Vector2d push = Eigen::Vector2d::Zero();
  const auto add = [&](const Eigen::Vector2d& normal, double distance_m) {
    if (distance_m < gap_m && normal.dot(to.direction) < kAhead)
      push += (gap_m - distance_m) * normal;
  };
  const Eigen::Vector2d low = to.nearest_m - walkable.ground().min_m;
  const Eigen::Vector2d high = walkable.ground().max_m - to.nearest_m;
  add(Eigen::Vector2d::UnitX(), low.x());
  add(Eigen::Vector2d::UnitY(), low.y());
  add(-Eigen::Vector2d::UnitX(), high.x());
  add(-Eigen::Vector2d::UnitY(), high.y());
  for (const uint32_t footprint : walkable.nearby_footprints(to.nearest_m)) {
    const Walkable::Nearest wall = walkable.nearest(footprint, to.nearest_m);
    add(wall.normal, wall.distance_m);
  }
  return push.norm();
}

}  // namespace

bool is_closest_possible(const Walkable& walkable, const Area& area, const Eigen::Vector2d& point,
                         double radius_m, double wall_offset_m) {
  const NearestPoint to(area, point);
  const double gap_m = radius_m + wall_offset_m;
  const bool is_shallow = !area.contains(to.nearest_m + kStep_m * to.direction);
  const bool is_closest =
      (is_shallow && to.left_m <= radius_m) ||
      to.left_m <= stopping_distance_m(walkable, to, gap_m) ||
      (to.left_m <= gap_m && walkable.gap_at(to.nearest_m, 2 * radius_m).width_m < 2 * radius_m);
  return is_closest && is_freely_reachable(walkable, area, point);
}

bool is_freely_reachable(const Walkable& walkable, const Area& area, const Eigen::Vector2d& point) {
  const Eigen::Vector2d nearest_m = area.nearest_inside_m(point, 2 * kFree_m);
  return walkable.clearance_m(nearest_m) >= kFree_m && !walkable.crosses(point, nearest_m);
}

}  // namespace throng
