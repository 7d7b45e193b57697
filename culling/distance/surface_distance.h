// How far apart the surfaces of two parts are, and where they are nearest.
// One rule: an interval that holds the distance, proven from both sides: two points of the
// surfaces, and for all else a gap along a direction, of triangles or of the boxes around them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "culling/distance/hull_depth.h"
#include "culling/triangles/triangle_bvh.h"
#include "culling/triangles/triangle_test.h"

namespace throng {

/// A surface where it is, and the hull of its corners. Scale and pose as in base/pose.h.
struct PlacedSurface {
  const TriangleBvh* surface = nullptr;
  const ConvexHull* hull = nullptr;
  const PartPose* pose = nullptr;
  float scale = 1;
};

/// What is known before the triangles are asked: along `direction` (unit, world axes, from A to B)
/// the surfaces lie at least `lo_m` apart; and where A may be nearest to B, relative to A's root.
struct KnownGap {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  double lo_m = 0;
  Eigen::Vector3d guess_m = Eigen::Vector3d::Zero();
};

/// The search ends with two points that are no farther apart than the surfaces by more than this.
/// An interval may be 1 mm wide; at 100 m the rounding of frames takes the rest of it.
inline constexpr double kDistanceTolerance_m = 8.8e-4;

struct SurfaceGap {
  double lo_m = 0,
         hi_m = 0;  ///< hold the distance; at most kDistanceTolerance_m and 1 um apart on a body
  NearestPoints points_m;  ///< at hi_m from each other; relative to A's root, in world axes
};

/// Of surfaces that do not touch. Nothing if they are proven farther apart than `within_m`.
/// a_to_b_m is B's root minus A's. No allocation.
std::optional<SurfaceGap> surface_gap(const PlacedSurface& a, const PlacedSurface& b,
                                      const Eigen::Vector3f& a_to_b_m, double within_m,
                                      const KnownGap& known, TriangleCounters& counters);

// Where two parts touch: one point that both share.
// One rule: it lies where triangles cross, and no crossing is nearer by more than
// kContactPointTolerance_m to a place that is given (where the hulls are deepest in each other); or
// inside a solid, where one part holds the other.

/// Half of the time went into the last centimetre.
inline constexpr double kContactPointTolerance_m = 0.01;

/// Relative to A's root, in world axes, as guess_m; nothing for parts that do not touch. No
/// allocation.
std::optional<Eigen::Vector3d> contact_point(const PlacedSurface& a, const PlacedSurface& b,
                                             const Eigen::Vector3f& a_to_b_m,
                                             const Eigen::Vector3d& guess_m,
                                             TriangleCounters& counters);

}  // namespace throng
