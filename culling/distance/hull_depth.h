// How deep two parts are in each other: the least translation that parts their convex hulls, over
// all directions; and how far apart the hulls are.
// One rule: a depth is never below the true value and at most 1 mm above it; every answer carries
// the bounds that prove it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "culling/distance/growing_polytope.h"
#include "culling/triangles/triangle_test.h"

namespace throng {

// Which corners of a convex hull can be the farthest along a direction: a few, looked up by the
// cell of a cube that the direction passes through.
// One rule: the farthest corner is always among them.

class SupportMap {
 public:
  SupportMap() = default;
  /// Of the first `corners` rows of `points`; kMaxCorners at most, others have no map.
  SupportMap(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, Eigen::Index corners);

  static constexpr Eigen::Index kFewCorners = 8;  ///< looked at one by one as quickly
  static constexpr Eigen::Index kMaxCorners = 0x10000;

  bool is_empty() const { return corners_.empty(); }
  /// Ascending. A direction of any length.
  std::span<const uint16_t> along(const Eigen::Vector3d& direction) const {
    const size_t cell = cell_of(direction);
    return {corners_.data() + start_[cell], start_[cell + 1] - start_[cell]};
  }

 private:
  static constexpr int kSide = 8;  ///< cells along an edge of the cube
  static constexpr size_t kCells = size_t{6} * kSide * kSide;

  static size_t cell_of(const Eigen::Vector3d& direction);
  void add_cell(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, Eigen::Index corners,
                size_t cell);

  std::vector<uint32_t> start_;
  std::vector<uint16_t> corners_;
};

/// The points of a part, made ready once: those that its convex hull rests on, and all.
class ConvexHull {
 public:
  /// At least one point (asserted), in the part's own frame, metres. Flat ones, needles and single
  /// points are hulls, too.
  explicit ConvexHull(std::span<const Eigen::Vector3f> points);

  /// All points lie within kShare of the hull of the first corner_count() of them.
  static constexpr double kShare = 1e-7;  ///< as a share of the part's size
  int corner_count() const { return corner_count_; }
  /// Corners first, a column a coordinate.
  const Eigen::Matrix<double, Eigen::Dynamic, 3>& points() const { return points_; }

  /// The corner farthest along a direction.
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const;
  /// How far any point lies along it.
  double extent(const Eigen::Vector3d& direction) const;
  /// How far from the origin of the part's frame the farthest point is.
  double reach_m() const { return reach_m_; }
  /// By how much at most a point reaches beyond the corners, along any unit direction.
  double beyond_corners_m() const { return beyond_corners_m_; }
  /// No point lies farther along a direction of any length; the farthest by less than a hair.
  double support_bound(const Eigen::Vector3d& direction) const {
    return direction.dot(support(direction)) + direction.norm() * beyond_corners_m_;
  }

 private:
  Eigen::Matrix<double, Eigen::Dynamic, 3> points_;
  int corner_count_ = 0;
  double beyond_corners_m_ = 0, reach_m_ = 0;
  SupportMap supports_;
};

struct PlacedPoints;

/// A hull where it is in a frame that both share. Scale and pose as in base/pose.h.
struct PlacedHull {
  const ConvexHull* hull = nullptr;
  const PartPose* pose = nullptr;
  float scale = 1;
};

struct Depth {
  double depth_m = 0;      ///< 0: apart (by 1 um or more), or touching
  double min_depth_m = 0;  ///< of the true value, proven; at most 0.5 mm below depth_m
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit; B moved by depth_m along it
                                                         ///< is out of A
  /// About where A's hull and B's meet once B has moved: points of theirs, relative to A's root, in
  /// world axes.
  NearestPoints points_m{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

/// Finds depths of pairs, one after another, without allocating once it has seen the largest. One a
/// thread.
class DepthFinder {
 public:
  /// a_to_b_m is B's root minus A's, as in solids_touch().
  Depth depth(const PlacedHull& a, const PlacedHull& b, const Eigen::Vector3f& a_to_b_m);

  /// Corners of the polytope that the latest pair needed: what its time grows with.
  size_t corners_used() const { return inside_.points().size(); }

 private:
  struct Fineness;
  Depth find(const PlacedPoints& a, const PlacedPoints& b, const Fineness& fineness);
  uint32_t lowest_face();

  struct Face {
    double distance;
    uint32_t slot;
    /// Heaps of the standard library have their last element in front.
    friend bool operator<(const Face& p, const Face& q) {
      return std::pair(q.distance, q.slot) < std::pair(p.distance, p.slot);
    }
  };

  GrowingPolytope inside_;             ///< of the differences of points of A and of B
  std::vector<Eigen::Vector3d> on_a_;  ///< the point of A of each
  std::vector<Face> lowest_;           ///< a heap of its faces, and of some that are gone
};

// How far apart the convex hulls of two parts are (Gilbert, Johnson & Keerthi, A fast procedure for
// computing the distance between complex objects, IEEE J. Robotics and Automation 4(2), 1988).
// One rule: the lower bound is proven by a gap along a direction, whether or not the search has
// converged.

struct HullGap {
  double lo_m = 0;        ///< no two points of the parts are nearer; 0: perhaps they overlap
  double distance_m = 0;  ///< the distance of the hulls, found to 0.1 mm where it converged
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< along which lo_m is proven: unit,
                                                         ///< world axes, from A to B
  double corner_distance_m =
      0;  ///< the distance of two corners that were met: the parts are not farther
  NearestPoints points_m =
      {};  ///< of the hulls, at distance_m; relative to A's root, in world axes
};

/// `direction`: unit, from A to B, to begin with. a_to_b_m is B's root minus A's, as in
/// solids_touch(). No allocation.
HullGap hull_gap(const PlacedHull& a, const PlacedHull& b, const Eigen::Vector3f& a_to_b_m,
                 const Eigen::Vector3d& direction);

}  // namespace throng
