// surface_gap() computes the distance between the surfaces of two parts and their nearest points.
// Invariant: both bounds are proven: the upper by two points of the surfaces, the lower by gaps
// along directions, of triangles or their boxes.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "culling/distance/hull_depth.h"
#include "culling/triangles/triangle_bvh.h"
#include "culling/triangles/triangle_test.h"

namespace throng {

/// Surface with its scale and pose, and the hull of its corners, as in base/pose.h.
struct PlacedSurface {
  const TriangleBvh* surface = nullptr;
  const ConvexHull* hull = nullptr;
  const PartPose* pose = nullptr;
  float scale = 1;
};

/// Known before the test of triangles. The surfaces are at least `lo_m` apart along `direction`
/// (unit, world axes, from A to B). A is nearest to B near a point, relative to A's root.
struct KnownGap {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  double lo_m = 0;
  Eigen::Vector3d guess_m = Eigen::Vector3d::Zero();
};

/// The upper bound exceeds the distance by at most this, in metres. A distance may have 1 mm
/// between its bounds; at 100 m the rounding of frames takes the rest.
inline constexpr double kDistanceTolerance_m = 8.8e-4;

struct SurfaceGap {
  /// Distance bounds, at most kDistanceTolerance_m + 1 um apart for parts of the size of a body.
  double lo_m = 0, hi_m = 0;
  NearestPoints points_m;  ///< hi_m apart; relative to A's root, in world axes
};

/// Distance of surfaces that do not touch; null if proven farther apart than `within_m`. a_to_b_m:
/// B's root minus A's. Does not allocate.
std::optional<SurfaceGap> surface_gap(const PlacedSurface& a, const PlacedSurface& b,
                                      const Eigen::Vector3f& a_to_b_m, double within_m,
                                      const KnownGap& known, TriangleCounters& counters);

// contact_point() finds a point that two touching parts share.
// Invariant: it lies where triangles cross, and no crossing is closer to the given point by more
// than kContactPointTolerance_m. If one part is inside the other, it lies inside the solid.

/// In metres. A smaller tolerance is slow: the last centimetre took half of the time.
inline constexpr double kContactPointTolerance_m = 0.01;

/// guess_m: point where the hulls are deepest in each other. Points are relative to A's root, in
/// world axes. Null if the parts do not touch. Does not allocate.
std::optional<Eigen::Vector3d> contact_point(const PlacedSurface& a, const PlacedSurface& b,
                                             const Eigen::Vector3f& a_to_b_m,
                                             const Eigen::Vector3d& guess_m,
                                             TriangleCounters& counters);

}  // namespace throng
