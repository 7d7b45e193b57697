// The navigation mesh of a scene: Recast builds it from ground and obstacles, Detour answers paths.
// One rule: built once, on one thread, from whole voxels; Recast and Detour stay behind this
// header.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "crowd/crowd_plan.h"
#include "crowd/navigation/walkable.h"

namespace throng {

/// A way as its corners, the start first.
struct Path {
  std::vector<Eigen::Vector2d> corners_m;  ///< empty: the start is in nobody's reach
  bool arrives = false;  ///< false: the last corner is where the way ends, as near as it gets
  double length_m() const;
};

class NavMesh {
 public:
  /// Where a person's centre may pass: the ground less footprints (convex, see footprint_of())
  /// wider by a body. Gaps between them are open along `passages` and shut along `closures`, as the
  /// flow fields have it. Voxels are 0.1 m, or as fine as a million of them, and 15 000 in a row,
  /// allow.
  NavMesh(const Rectangle& ground, std::span<const std::vector<Eigen::Vector2d>> footprints,
          std::span<const Passage> passages = {}, std::span<const Passage> closures = {});
  ~NavMesh();
  NavMesh(NavMesh&&) noexcept;

  /// False if the scene has more corners than a mesh of Recast can hold (65 534), or no ground that
  /// anybody can stand on: it knows no ways.
  bool is_built() const;
  int polygon_count() const;
  double voxel_m() const;

  /// Names the connected piece of ground that a point is on, or at most 0.5 m from; -1 if none.
  /// Any thread may ask.
  int piece_at(const Eigen::Vector2d& point) const;

  /// The way from one point to another, its corners pulled tight. One caller at a time.
  Path path(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  /// The shortest way to the middle of one of several areas, or as near to it as can be stood. One
  /// caller at a time.
  Path path(const Eigen::Vector2d& from, std::span<const Rectangle> areas) const;

 private:
  Eigen::Vector2d place_in(const Rectangle& area, int piece) const;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
