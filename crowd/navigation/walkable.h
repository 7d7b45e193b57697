// Where people may stand: the ground less the footprints of obstacles, and the hard rule of walls.
// One rule: nobody's centre ever enters a footprint or leaves the ground, whatever steering
// decides.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "crowd/crowd_plan.h"

namespace throng {

/// A straight way between two points that somebody can walk.
struct Passage {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
};

/// What is between two walls.
struct Gap {
  double width_m = std::numeric_limits<double>::infinity();  ///< by way of the point asked about
  Passage across{};                                          ///< from wall to wall
};

class Walkable {
 public:
  /// Footprints are convex and counter-clockwise, see footprint_of(). Throws InputError if there
  /// are so many so large that looking them up would fill the memory.
  Walkable(const Rectangle& ground, const std::vector<std::vector<Eigen::Vector2d>>& footprints);

  /// The ground and the obstacles that stand in people's way; then its doors, all of them open.
  explicit Walkable(const CrowdPlan& plan);

  /// Which leaves stand in the way from now on, one a door of the scene.
  void shut(std::span<const uint8_t> doors);
  /// Of a door's leaf, whether it is shut or not.
  uint32_t footprint_of_door(size_t door) const {
    return first_door_ + static_cast<uint32_t>(door);
  }

  /// How far from a point obstacles are looked up. A walker sees walls 2.2 m ahead (the fastest
  /// free speed for half a second, plus a radius); the coarsest flow field keeps 2.2 m from them.
  static constexpr double kReach_m = 2.5;

  struct Nearest {
    Eigen::Vector2d normal =
        Eigen::Vector2d::UnitX();  ///< unit, out of the footprint, to the point
    double distance_m = 0;         ///< negative inside
  };

  const Rectangle& ground() const { return ground_; }
  /// Corners of every footprint, doors left out.
  std::vector<std::vector<Eigen::Vector2d>> footprints() const;
  /// Indices of all footprints within kReach_m of the point, perhaps some others; ascending.
  std::span<const uint32_t> nearby_footprints(const Eigen::Vector2d& point) const;
  Nearest nearest(uint32_t footprint, const Eigen::Vector2d& point) const;
  /// Distance to the nearest footprint or edge of the ground, at most kReach_m; negative inside a
  /// footprint or off the ground.
  double clearance_m(const Eigen::Vector2d& point) const;
  /// True if the clearance is at least `gap_m` at all inner points that cut a straight way into so
  /// many pieces.
  bool is_clear_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double gap_m,
                        int pieces) const;
  /// The same as clearance_m, edges of the ground left out.
  double obstacle_clearance_m(const Eigen::Vector2d& point) const;
  /// The narrowest gap that a point lies in: between two walls (or edges of the ground) on opposite
  /// sides of it, each nearer than `reach_m`, at least one of them an obstacle.
  Gap gap_at(const Eigen::Vector2d& point, double reach_m) const;
  /// Where a walker who wants to go from a walkable point `from` to `to` (less than 1 m) ends: kept
  /// `gap_m` off walls by sliding along them, or left at `from` if that would enter or cross one.
  Eigen::Vector2d slide(const Eigen::Vector2d& from, Eigen::Vector2d to, double gap_m) const;
  /// True if the straight way runs through the inside of a footprint near `from`.
  bool crosses(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

 private:
  struct Edge {
    Eigen::Vector2d start;
    Eigen::Vector2d along;   ///< end - start
    Eigen::Vector2d normal;  ///< unit, outwards
  };

  std::span<const Edge> edges_of(uint32_t footprint) const;
  bool crosses(uint32_t footprint, const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  void add_footprint(std::span<const Eigen::Vector2d> corners);
  void build_cells();
  int cell_of(double offset_m, int cells) const;

  Rectangle ground_;
  std::vector<Edge> edges_;
  std::vector<uint32_t> edge_starts_;  ///< footprints + 1 entries
  uint32_t first_door_ = 0;            ///< footprints from here on are those of doors
  std::vector<uint8_t> is_shut_;       ///< by door
  double cell_m_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<uint32_t> cell_starts_;  ///< cells + 1 entries into cell_footprints_
  std::vector<uint32_t> cell_footprints_;
};

}  // namespace throng
