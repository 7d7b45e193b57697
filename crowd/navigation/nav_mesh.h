// NavMesh answers path queries: Recast builds the mesh from ground and obstacles, Detour searches
// it.
// Invariant: built once, on one thread, from whole voxels. Recast and Detour are hidden here.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "crowd/crowd_plan.h"
#include "crowd/navigation/walkable.h"

namespace throng {

/// A path as a polyline, start first.
struct Path {
  std::vector<Eigen::Vector2d> corners_m;  ///< empty: the start is too far from the mesh
  bool arrives = false;  ///< false: the last corner is the reachable point nearest to the end
  double length_m() const;
};

class NavMesh {
 public:
  /// The mesh covers the floor (empty: the ground) minus footprints (convex, see footprint_of())
  /// inflated by a body. As in the flow fields, gaps are open along `passages` and shut along
  /// `closures`. Voxels are 0.1 m, or as fine as a million of them, and 15 000 per row, allow.
  NavMesh(const Rectangle& ground, std::span<const std::vector<Eigen::Vector2d>> footprints,
          std::span<const Passage> passages = {}, std::span<const Passage> closures = {},
          const std::vector<Polygon>& floor = {});
  ~NavMesh();
  NavMesh(NavMesh&&) noexcept;

  /// Returns false if the scene has no walkable ground, or more corners than Recast supports (65
  /// 534). Then there are no paths.
  bool is_built() const;
  int polygon_count() const;
  double voxel_m() const;

  /// Returns the piece of connected ground at most 0.5 m from a point; -1 if none. Thread-safe.
  int piece_at(const Eigen::Vector2d& point) const;

  /// Returns the shortest path between two points. One caller at a time.
  Path path(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  /// Returns the shortest path to the middle of one of several areas, or to the nearest reachable
  /// point. One caller at a time.
  Path path(const Eigen::Vector2d& from, std::span<const Area> areas) const;

 private:
  Eigen::Vector2d place_in(const Area& area, int piece) const;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
