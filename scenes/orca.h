// Optimal reciprocal collision avoidance (van den Berg, Guy, Lin, Manocha 2011): half-planes of
// velocities that stay clear of others, and the velocity nearest to the wanted one in all of them.
// One rule: hard planes are never given up; where the others contradict each other, the worst
// violation is made as small as it can be.
#pragma once

#include <Eigen/Core>
#include <span>

namespace throng {

/// Velocities v with normal . v >= offset_mps.
struct HalfPlane {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit
  double offset_mps = 0;

  /// Positive outside: how far v lies from the half-plane.
  double violation_mps(const Eigen::Vector2d& v) const { return offset_mps - normal.dot(v); }
};

/// The other's disc as seen from a walker.
struct Encounter {
  Eigen::Vector2d offset_m;  ///< other's position - own position
  Eigen::Vector2d own_velocity_mps;
  Eigen::Vector2d other_velocity_mps;
  double radius_m = 0;   ///< sum of both radii
  double horizon_s = 2;  ///< no collision for so long
  double step_s = 0.1;   ///< discs that overlap already part within a step
};

/// What the walker contributes: half of the change that avoids the collision.
HalfPlane avoid(const Encounter& encounter);

/// A wall that cannot move aside: never come nearer to it than the clearance left over the horizon.
/// `normal` points from the wall to the walker. Standing still is always allowed, so that any
/// number of walls agree.
HalfPlane keep_off(const Eigen::Vector2d& normal, double clearance_m, double horizon_s);

/// The velocity of length at most max_speed_mps nearest to `wanted_mps` that satisfies all planes.
/// The first `hard` planes must leave standing still possible. If not all can be met, the velocity
/// that violates the worst of the others least.
Eigen::Vector2d choose_velocity(std::span<const HalfPlane> planes, int hard,
                                const Eigen::Vector2d& wanted_mps, double max_speed_mps);

}  // namespace throng
