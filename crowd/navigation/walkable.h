// Walkable is the floor minus the footprints of obstacles. Strips along the outside of the floor's
// edges are also footprints.
// Invariant: no agent's centre enters a footprint or leaves the floor, regardless of steering.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "crowd/crowd_plan.h"

namespace throng {

/// A straight segment that an agent can walk.
struct Passage {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
};

/// Space between two walls.
struct Gap {
  double width_m = std::numeric_limits<double>::infinity();  ///< measured through the query point
  Passage across{};                                          ///< segment from wall to wall
};

class Walkable {
 public:
  /// Footprints are convex and counter-clockwise, see footprint_of(). Throws InputError if their
  /// look-up table would exceed the memory limit.
  Walkable(const Rectangle& ground, const std::vector<std::vector<Eigen::Vector2d>>& footprints);

  /// Uses the floor, the obstacles that block agents, then all doors, initially open.
  explicit Walkable(const CrowdPlan& plan);

  /// Sets which doors are shut; one entry per door.
  void shut(std::span<const uint8_t> doors);
  /// Footprint index of a door's leaf, shut or not.
  uint32_t footprint_of_door(size_t door) const {
    return first_door_ + static_cast<uint32_t>(door);
  }

  /// Search radius for obstacles. An agent sees walls 2.2 m ahead: the highest desired speed for
  /// half a second, plus a radius. The coarsest flow field keeps 2.2 m from walls.
  static constexpr double kReach_m = 2.5;

  struct Nearest {
    Eigen::Vector2d normal =
        Eigen::Vector2d::UnitX();  ///< unit, out of the footprint, towards the point
    double distance_m = 0;         ///< negative inside
  };

  const Rectangle& ground() const { return ground_; }
  /// Polygons of the floor; empty: all of the ground.
  const std::vector<Polygon>& floor() const { return floor_; }
  /// Returns whether a point is on the ground and its floor.
  bool is_on_floor(const Eigen::Vector2d& point) const {
    return ground_.contains(point) && (!locator_ || locator_->contains(point));
  }
  /// Number of the surface whose piece a footprint is; 0: of none.
  uint32_t surface_of(uint32_t footprint) const { return surfaces_[footprint]; }
  /// Corners of all footprints except doors, and the strips first.
  std::vector<std::vector<Eigen::Vector2d>> footprints() const;
  /// Indices of all footprints within kReach_m of the point, possibly with some others; ascending.
  std::span<const uint32_t> nearby_footprints(const Eigen::Vector2d& point) const;
  Nearest nearest(uint32_t footprint, const Eigen::Vector2d& point) const;
  /// Returns true only if a footprint is at least `reach_m` (0 or more) from a point; much faster
  /// than nearest(). A floor of thousands of edges has dozens of footprints near any point.
  bool is_beyond(uint32_t footprint, const Eigen::Vector2d& point, double reach_m) const {
    const Disc& disc = discs_[footprint];
    const double max_m = reach_m + disc.radius_m;
    return (point - disc.centre_m).squaredNorm() >= max_m * max_m;
  }
  /// Distance to the nearest footprint or edge of the ground, at most kReach_m; negative inside a
  /// footprint or off the floor.
  double clearance_m(const Eigen::Vector2d& point) const;
  /// Returns whether the clearance is at least `gap_m` at the points that cut a segment into
  /// pieces.
  bool is_clear_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double gap_m,
                        int pieces) const;
  /// The same as clearance_m(), without edges of the ground.
  double obstacle_clearance_m(const Eigen::Vector2d& point) const;
  /// The same, of these footprints only.
  double obstacle_clearance_m(const Eigen::Vector2d& point,
                              std::span<const uint32_t> footprints) const;
  /// The narrowest gap that contains a point: between two walls (or edges of the ground) on
  /// opposite sides, each nearer than `reach_m`. At least one is an obstacle.
  Gap gap_at(const Eigen::Vector2d& point, double reach_m) const;
  /// The same, between these footprints and edges of the ground.
  Gap gap_at(const Eigen::Vector2d& point, double reach_m,
             std::span<const uint32_t> footprints) const;
  /// Returns where an agent ends that moves from a walkable point `from` to `to` (less than 1 m).
  /// It slides along walls at `gap_m`, and stays at `from` if it would enter or cross one.
  Eigen::Vector2d slide(const Eigen::Vector2d& from, Eigen::Vector2d to, double gap_m) const;
  /// Returns whether the straight segment runs through the inside of a footprint near `from`.
  bool crosses(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

 private:
  struct Edge {
    Eigen::Vector2d start;
    Eigen::Vector2d along;   ///< end - start
    Eigen::Vector2d normal;  ///< unit, outwards
  };

  /// Disc around a footprint.
  struct Disc {
    Eigen::Vector2d centre_m;
    double radius_m = 0;
  };

  std::span<const Edge> edges_of(uint32_t footprint) const;
  bool crosses(uint32_t footprint, const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  void add_footprint(std::span<const Eigen::Vector2d> corners, uint32_t surface = 0);
  void build_cells();
  int cell_of(double offset_m, int cells) const;

  Rectangle ground_;
  std::vector<Polygon> floor_;
  std::optional<PolygonLocator> locator_;
  std::vector<Edge> edges_;
  std::vector<Disc> discs_;            ///< by footprint
  std::vector<uint32_t> surfaces_;     ///< per footprint
  std::vector<uint32_t> edge_starts_;  ///< footprints + 1 entries
  uint32_t first_door_ = 0;            ///< first footprint of a door
  std::vector<uint8_t> is_shut_;       ///< per door
  double cell_m_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<uint32_t> cell_starts_;  ///< cells + 1 entries into cell_footprints_
  std::vector<uint32_t> cell_footprints_;
};

}  // namespace throng
