// How deep two parts are in each other: the least translation that parts their convex hulls, over
// all directions.
// One rule: never below the true value and at most 1 mm above it; every answer carries the bounds
// that prove it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "culling/distance/growing_polytope.h"
#include "culling/distance/support_map.h"
#include "culling/exact/segments.h"

namespace throng {

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
  double ends(const Eigen::Vector3d& direction) const {
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
  double depth_m = 0;     ///< 0: apart (by 1 um or more), or touching
  double at_least_m = 0;  ///< of the true value, proven; at most 0.5 mm below depth_m
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

}  // namespace throng
