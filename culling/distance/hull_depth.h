// DepthFinder computes the penetration depth of two convex hulls: the least translation, over all
// directions, that separates them. hull_gap() computes their distance.
// Invariant: a depth is never below the true value and at most 1 mm above it; every result has
// proven bounds.
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

// SupportMap looks up the few corners of a convex hull that can be the farthest along a direction.
// Each cell of a cube stores those of the directions through it.
// Invariant: the farthest corner is always among them.

class SupportMap {
 public:
  SupportMap() = default;
  /// Maps the first `corners` rows of `points`. Hulls with more than kMaxCorners have no map.
  SupportMap(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, Eigen::Index corners);

  static constexpr Eigen::Index kFewCorners = 8;  ///< a linear search is as fast
  static constexpr Eigen::Index kMaxCorners = 0x10000;

  bool is_empty() const { return corners_.empty(); }
  /// Candidates for a direction of any length, ascending.
  std::span<const uint16_t> along(const Eigen::Vector3d& direction) const {
    const size_t cell = cell_of(direction);
    return {corners_.data() + start_[cell], start_[cell + 1] - start_[cell]};
  }

 private:
  static constexpr int kSide = 8;  ///< number of cells along an edge of the cube
  static constexpr size_t kCells = size_t{6} * kSide * kSide;

  static size_t cell_of(const Eigen::Vector3d& direction);
  void add_cell(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, Eigen::Index corners,
                size_t cell);

  std::vector<uint32_t> start_;
  std::vector<uint16_t> corners_;
};

/// Points of a part, preprocessed: first those that its convex hull rests on, then the others.
class ConvexHull {
 public:
  /// `points`: at least one (asserted), in the part's frame, in metres. May be degenerate.
  explicit ConvexHull(std::span<const Eigen::Vector3f> points);

  /// All points lie within kShare of the hull of the first corner_count() points.
  static constexpr double kShare = 1e-7;  ///< as a share of the part's size
  int corner_count() const { return corner_count_; }
  /// All points as rows, corners first.
  const Eigen::Matrix<double, Eigen::Dynamic, 3>& points() const { return points_; }

  /// Corner that is farthest along a direction.
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const;
  /// Maximum projection of a point on a direction.
  double extent(const Eigen::Vector3d& direction) const;
  /// Distance of the farthest point from the origin of the part's frame, in metres.
  double reach_m() const { return reach_m_; }
  /// Maximum distance of a point beyond the corners, along any unit direction.
  double beyond_corners_m() const { return beyond_corners_m_; }
  /// Upper bound of all points along a direction of any length, and a tight one.
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

/// Hull with its scale and pose in a frame that both parts share, as in base/pose.h.
struct PlacedHull {
  const ConvexHull* hull = nullptr;
  const PartPose* pose = nullptr;
  float scale = 1;
};

struct Depth {
  double depth_m = 0;      ///< penetration depth; 0: touching, or apart (by 1 um or more)
  double min_depth_m = 0;  ///< proven lower bound of the depth; at most 0.5 mm below depth_m
  /// Unit direction of least penetration: B moved by depth_m along it no longer penetrates A.
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  /// Approximate contact points after B has moved out, relative to A's root, in world axes.
  NearestPoints points_m{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

/// Computes depths of pairs. Keeps scratch memory, and allocates only for a pair larger than all
/// before. Use one instance per thread.
class DepthFinder {
 public:
  /// a_to_b_m: B's root minus A's, as in solids_touch().
  Depth depth(const PlacedHull& a, const PlacedHull& b, const Eigen::Vector3f& a_to_b_m);

  /// Number of corners of the polytope for the latest pair. The time grows with it.
  size_t corners_used() const { return inside_.points().size(); }

 private:
  struct Tolerances;
  Depth find(const PlacedPoints& a, const PlacedPoints& b, const Tolerances& tolerances);
  uint32_t lowest_face();

  struct Face {
    double distance;
    uint32_t slot;
    /// Reversed, because heaps of the standard library have the largest element in front.
    friend bool operator<(const Face& p, const Face& q) {
      return std::pair(q.distance, q.slot) < std::pair(p.distance, p.slot);
    }
  };

  GrowingPolytope inside_;             ///< polytope of differences of points of A and of B
  std::vector<Eigen::Vector3d> on_a_;  ///< indexed by point of the polytope: its point of A
  std::vector<Face> lowest_;           ///< heap of faces, including some removed ones
};

// hull_gap() computes the distance of the convex hulls of two parts.
// Method: Gilbert, Johnson & Keerthi, A fast procedure for computing the distance between complex
// objects, IEEE J. Robotics and Automation 4(2), 1988.
// Invariant: the lower bound is proven by a gap along a direction, even if the search has not
// converged.

struct HullGap {
  double lo_m = 0;        ///< proven lower bound of the distance of the parts; 0: they may overlap
  double distance_m = 0;  ///< distance of the hulls, accurate to 0.1 mm if converged
  /// Direction that proves lo_m: unit, world axes, from A to B.
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  /// Distance of two corners, an upper bound of the distance of the parts.
  double corner_distance_m = 0;
  /// Points of the hulls, distance_m apart; relative to A's root, in world axes.
  NearestPoints points_m = {};
};

/// `direction`: unit initial direction, from A to B. a_to_b_m: B's root minus A's, as in
/// solids_touch(). Does not allocate.
HullGap hull_gap(const PlacedHull& a, const PlacedHull& b, const Eigen::Vector3f& a_to_b_m,
                 const Eigen::Vector3d& direction);

}  // namespace throng
